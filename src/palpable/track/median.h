/// @file
/// The middle one of some numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace palpable {

/// Of an even number of values the upper of the middle two. Takes no memory.
/// @param values  at least one, no NaN; their order is changed
[[nodiscard]] inline double median(std::span<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace palpable
