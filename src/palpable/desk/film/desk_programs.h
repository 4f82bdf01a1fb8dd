/// @file
/// The shaders that film the desk, compiled: a program for each kind of surface and for each way to
/// read the sensor. OpenGL's names and terms; the context must be current.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/render/gl_objects.h"

#include <array>

namespace palpable {

/// A program that paints a kind of surface (desk.vert and desk.frag), and what it was compiled for:
/// it has the uniforms of nothing else.
struct Paint {
  GlProgram program;
  bool far = false;             ///< lit at the vertices, outside of all shadows
  bool moves = false;           ///< between two moments
  bool sun = true;              ///< false: the surface faces away from the sun
  bool still_shadows = false;   ///< things that stand still cast shadows on it
  bool moving_shadows = false;  ///< movers cast shadows on it
};

/// What draws the ideal picture of an eye, shadow maps and depth.
struct PaintPrograms {
  GlProgram shade;      ///< depth from the sun, into a shadow map
  GlProgram measure;    ///< the truth of depth
  GlProgram light_top;  ///< how much sun reaches the desk's top, from a shadow map

  // What stands still: far away; with the shadows of still things, or of all; the desk's top.
  Paint far, still, all, still_top, all_top;
  // What moves; index: [with nails and creases].
  std::array<Paint, 2> mover, mover_in_shade;
  Paint mover_dark;
};

/// What turns ideal pictures into a raw one (sensor.frag).
struct SensorPrograms {
  GlProgram sharp;  ///< a picture of one moment
  GlProgram rows;   ///< rows that are read one after the other
  /// An exposure; index: [with layers of movers][the eye turns].
  std::array<std::array<GlProgram, 2>, 2> exposed;
};

struct DeskPrograms {
  PaintPrograms paint;
  SensorPrograms sensor;

  /// A problem when a shader does not compile.
  static Result<DeskPrograms> make();
};

}  // namespace palpable
