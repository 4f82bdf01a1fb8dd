/// @file
/// What the values of scene_show.h are called: on panels, in their order, and on command lines.
#pragma once

#include "palpable/live/view/scene_show.h"

#include <array>
#include <cstddef>

namespace palpable {

inline constexpr std::array<const char*, 6> kFieldNames{"stress",  "pressure",     "component",
                                                        "contact", "displacement", "material"};
inline constexpr std::array<const char*, 6> kComponentNames{"xx", "yy", "zz", "xy", "yz", "zx"};
inline constexpr std::array<const char*, 3> kOcclusionNames{"none", "hard", "soft"};

/// What may be painted, as the option --paint says it.
struct NamedPaint {
  const char* name;
  SceneShow::Field field;
  SceneShow::Component component = SceneShow::Component::kZz;
};
inline constexpr std::array<NamedPaint, 11> kPaints{
    {{"stress", SceneShow::Field::kVonMises},
     {"pressure", SceneShow::Field::kPressure},
     {"sxx", SceneShow::Field::kComponent, SceneShow::Component::kXx},
     {"syy", SceneShow::Field::kComponent, SceneShow::Component::kYy},
     {"szz", SceneShow::Field::kComponent, SceneShow::Component::kZz},
     {"sxy", SceneShow::Field::kComponent, SceneShow::Component::kXy},
     {"syz", SceneShow::Field::kComponent, SceneShow::Component::kYz},
     {"szx", SceneShow::Field::kComponent, SceneShow::Component::kZx},
     {"contact", SceneShow::Field::kContact},
     {"displacement", SceneShow::Field::kDisplacement},
     {"none", SceneShow::Field::kNone}}};

/// The value after `value` of those that `names` names; the first after the last one.
template <class Value, std::size_t N>
[[nodiscard]] Value next_of(Value value, const std::array<const char*, N>& /*names*/) {
  return static_cast<Value>((static_cast<std::size_t>(value) + 1) % N);
}

}  // namespace palpable
