/// @file
/// What of a scene people see: chosen once, or changed while a run goes on (keys, panel).
#pragma once

namespace palpable {

struct SceneShow {
  /// What is painted on bodies.
  enum class Field {
    kVonMises,      ///< Pa
    kPressure,      ///< Pa, minus a third of the stress's trace: above 0 where it is compressed
    kComponent,     ///< Pa, one of the six: `component`
    kContact,       ///< Pa, how hard things press there: SceneBody::contact_pressure
    kDisplacement,  ///< m, length of the displacement from the shape that was baked
    kNone           ///< the material alone
  };
  /// Of the Cauchy stress along the body frame's axes, in the order of SceneBody::cauchy. Normal
  /// ones are above 0 where the material is pulled along the axis.
  enum class Component { kXx, kYy, kZz, kXy, kYz, kZx };
  /// What real things do to bodies behind them.
  enum class Occlusion {
    kNone,  ///< nothing: bodies are always in front
    kHard,  ///< each pixel decides by its measured depth alone (paper Sec. 3.5)
    kSoft   ///< outlines at the picture's resolution, found together (render/outlines.h)
  };
  Field field = Field::kVonMises;
  Component component = Component::kZz;  ///< for Field::kComponent
  bool blended = true;  ///< low values let the material through; false: the colours alone
  Occlusion occlusion = Occlusion::kSoft;
  bool contacts = false;  ///< balls where bodies are touched
  bool forces = false;    ///< arrows: where, whither and how hard; of many touches the strongest
  bool legend = true;     ///< the bar of colours

  friend bool operator==(const SceneShow&, const SceneShow&) = default;
};

}  // namespace palpable
