/// @file
/// What the values of scene_show.h are called on panels, in their order.
#pragma once

#include <array>
#include <cstddef>

namespace palpable {

inline constexpr std::array<const char*, 3> kFieldNames{"stress", "displacement", "material"};
inline constexpr std::array<const char*, 3> kOcclusionNames{"none", "hard", "soft"};

/// The value after `value` of those that `names` names; the first after the last one.
template <class Value, std::size_t N>
[[nodiscard]] Value next_of(Value value, const std::array<const char*, N>& /*names*/) {
  return static_cast<Value>((static_cast<std::size_t>(value) + 1) % N);
}

}  // namespace palpable
