/// @file
/// Medians and percentiles.
///
///     values 1 2 3 4      percentile(values, 0.5) = 2.5      upper_median(values) = 3
///
/// Reports use percentile(). upper_median() is for the frame loop, which must not allocate, and for
/// results that have to be one of the values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// The value below which a share of the values lies: linear between the two nearest ranks, so that
/// share 0.5 of an even number of values is the mean of the middle two.
/// @param values  at least one, no NaN; any order
/// @param share   in [0, 1]
[[nodiscard]] double percentile(std::vector<double> values, double share);

/// The bin of a histogram in which the value lies below which a share of all values are; the last
/// bin for share 1. Allocates nothing.
/// @param bins   number of values in each bin, in increasing order of the values; not empty
/// @param count  of all values, > 0
/// @param share  in [0, 1]
[[nodiscard]] std::size_t percentile_bin(std::span<const std::uint32_t> bins, std::uint64_t count,
                                         double share);

/// The middle value; for an even number of values the larger of the middle two. Allocates nothing.
/// @param values  at least one, no NaN; their order is changed
template <class T>
[[nodiscard]] T upper_median(std::span<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}
template <class T>
[[nodiscard]] T upper_median(std::vector<T>& values) {
  return upper_median(std::span<T>(values));
}

}  // namespace palpable
