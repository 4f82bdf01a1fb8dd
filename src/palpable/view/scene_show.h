/// @file
/// What of a scene people see: chosen once, or changed while a run goes on (keys, panel).
#pragma once

namespace palpable {

struct SceneShow {
  /// What is painted on bodies.
  enum class Field {
    kVonMises,      ///< Pa
    kDisplacement,  ///< m, length of the displacement from the shape that was baked
    kNone           ///< the material alone
  };
  /// What real things do to bodies behind them.
  enum class Occlusion {
    kNone,  ///< nothing: bodies are always in front
    kHard,  ///< each pixel decides by its measured depth alone (paper Sec. 3.5)
    kSoft   ///< outlines at the picture's resolution, found together (render/outlines.h)
  };
  Field field = Field::kVonMises;
  bool blended = true;  ///< low values let the material through; false: the colours alone
  Occlusion occlusion = Occlusion::kSoft;
  bool contacts = false;  ///< balls where bodies are touched
  bool forces = false;    ///< arrows: where, whither and how hard; of many touches the strongest
  bool legend = true;     ///< the bar of colours

  friend bool operator==(const SceneShow&, const SceneShow&) = default;
};

}  // namespace palpable
