/// @file
/// The compiled shader programs that film the desk: one for each kind of surface and each way to
/// read the sensor. The OpenGL context must be current.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/render/gl_objects.h"

#include <array>

namespace palpable {

/// A program that paints one kind of surface (desk.vert and desk.frag), and the features that it
/// was compiled with. It has only the uniforms of these features.
struct Paint {
  GlProgram program;
  bool far = false;             ///< lit at the vertices, without shadows
  bool moves = false;           ///< interpolated between two instants
  bool sun = true;              ///< false: the surface faces away from the sun
  bool still_shadows = false;   ///< still things cast shadows on it
  bool moving_shadows = false;  ///< movers cast shadows on it
};

/// The programs that draw the ideal picture of an eye, shadow maps and depth.
struct PaintPrograms {
  GlProgram shade;      ///< depth from the sun, into a shadow map
  GlProgram measure;    ///< true depth
  GlProgram light_top;  ///< share of the sun on the desk's top, from a shadow map

  // Still surfaces: far away; with the shadows of still things, or of all things; the desk's top.
  Paint far, still, all, still_top, all_top;
  // Moving surfaces; index: [with nails and creases].
  std::array<Paint, 2> mover, mover_in_shade;
  Paint mover_dark;
};

/// The programs that compute a raw picture from ideal ones (sensor.frag).
struct SensorPrograms {
  GlProgram sharp;  ///< a picture of one instant
  GlProgram rows;   ///< rows that are read one after the other
  /// A picture with motion blur; index: [with layers of movers][the eye turns].
  std::array<std::array<GlProgram, 2>, 2> exposed;
};

struct DeskPrograms {
  PaintPrograms paint;
  SensorPrograms sensor;

  /// A problem when a shader does not compile.
  static Result<DeskPrograms> make();
};

}  // namespace palpable
