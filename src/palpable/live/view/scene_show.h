/// @file
/// What is shown of a scene: set once, or changed during a run (keys, panel).
#pragma once

#include "palpable/live/render/color_map.h"

namespace palpable {

struct SceneShow {
  /// The field that is painted on bodies.
  enum class Field {
    kVonMises,      ///< Pa
    kPressure,      ///< Pa, minus a third of the stress's trace; above 0 in compression
    kComponent,     ///< Pa, the component of stress chosen by `component`
    kContact,       ///< Pa, contact pressure on the skin: SceneBody::contact_pressure
    kDisplacement,  ///< m, length of the displacement from the shape that was baked
    kNone           ///< the material alone
  };
  /// Components of the Cauchy stress along the body frame's axes, in the order of
  /// SceneBody::cauchy. Normal components are above 0 in tension.
  enum class Component { kXx, kYy, kZz, kXy, kYz, kZx };
  /// How real things hide bodies behind them.
  enum class Occlusion {
    kNone,  ///< not at all: bodies are always in front
    kHard,  ///< each pixel by its measured depth alone (paper Sec. 3.5)
    kSoft   ///< by outlines at the picture's resolution (render/outlines.h)
  };
  Field field = Field::kVonMises;
  Component component = Component::kZz;         ///< for Field::kComponent
  ColorScale colors = ColorScale::kBlueYellow;  ///< of fields with one sign
  bool blended = true;  ///< low values show the material's own colour; false: the scale's colours
  Occlusion occlusion = Occlusion::kSoft;
  bool contacts = false;  ///< draw a ball at each touch
  bool forces = false;    ///< draw the forces of the strongest touches as arrows with their size
  bool legend = true;     ///< draw the colour bar

  friend bool operator==(const SceneShow&, const SceneShow&) = default;
};

}  // namespace palpable
