/// @file
/// Names of the values of scene_show.h, in the order of the enumerations, for panels and command
/// lines.
#pragma once

#include "palpable/common/base/contract.h"
#include "palpable/live/view/scene_show.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

namespace palpable {

inline constexpr std::array<const char*, 6> kFieldNames{"stress",  "pressure",     "component",
                                                        "contact", "displacement", "material"};
inline constexpr std::array<const char*, 6> kComponentNames{"xx", "yy", "zz", "xy", "yz", "zx"};
inline constexpr std::array<const char*, 3> kOcclusionNames{"none", "hard", "soft"};

/// Values of the option --colors.
inline constexpr std::array<const char*, 4> kColorScaleNames{"blue-yellow", "viridis", "rainbow",
                                                             "gray"};

/// A value of the option --paint.
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

/// The value of an enumeration with this name. @pre `name` is one of `names`
template <class Value, std::size_t N>
[[nodiscard]] Value value_named(const std::string& name, const std::array<const char*, N>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  PALPABLE_EXPECT(found != names.end(), "the name of a value is known");
  return static_cast<Value>(found - names.begin());
}

/// The next value of an enumeration with as many values as `names`; after the last one, the first.
template <class Value, std::size_t N>
[[nodiscard]] Value next_of(Value value, const std::array<const char*, N>& /*names*/) {
  return static_cast<Value>((static_cast<std::size_t>(value) + 1) % N);
}

}  // namespace palpable
