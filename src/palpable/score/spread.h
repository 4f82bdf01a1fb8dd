/// @file
/// A figure that every frame has, over many frames.
#pragma once

#include "palpable/base/order_statistics.h"

#include <optional>
#include <vector>

namespace palpable {

struct MedianAndP90 {
  double median = 0;
  double p90 = 0;  ///< nine frames of ten have less
};

/// Nothing of no frame.
[[nodiscard]] inline std::optional<MedianAndP90> median_and_p90(const std::vector<double>& frames) {
  if (frames.empty()) return std::nullopt;
  return MedianAndP90{percentile(frames, 0.5), percentile(frames, 0.9)};
}

}  // namespace palpable
