/// @file
/// Shares, and percentiles of a figure over many frames; nothing for an empty whole, or when there
/// is no frame.
#pragma once

#include "palpable/common/base/order_statistics.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace palpable {

/// part / whole; nothing when the whole is 0.
[[nodiscard]] inline std::optional<double> share_of(std::int64_t part, std::int64_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

struct MedianAndP90 {
  double median = 0;
  double p90 = 0;  ///< 90 % of the frames have less
};

struct P50AndP99 {
  double p50 = 0;  ///< the median
  double p99 = 0;  ///< 99 % of the frames have less
};

[[nodiscard]] inline std::optional<MedianAndP90> median_and_p90(const std::vector<double>& frames) {
  if (frames.empty()) return std::nullopt;
  return MedianAndP90{percentile(frames, 0.5), percentile(frames, 0.9)};
}

[[nodiscard]] inline std::optional<P50AndP99> p50_and_p99(const std::vector<double>& frames) {
  if (frames.empty()) return std::nullopt;
  return P50AndP99{percentile(frames, 0.5), percentile(frames, 0.99)};
}

}  // namespace palpable
