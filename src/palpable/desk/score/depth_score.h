/// @file
/// The error of measured depth, by distance and on near hands.
///
/// Depths are compared as the 16-bit counts of their files (geometry/depth_counts.h), in one unit
/// for truth and result.
#pragma once

#include "palpable/common/geometry/depth_counts.h"
#include "palpable/common/geometry/image.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace palpable {

/// The distances at which depth is scored, m. A pixel belongs to a distance if its true depth
/// differs from it by at most 15 %, and otherwise to none.
inline constexpr std::array kDepthDistances{0.2, 0.3, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0};

struct DepthAtDistance {
  std::int64_t pixels = 0;    ///< pixels at this true distance that both eyes see
  std::int64_t measured = 0;  ///< of these pixels, those with a measured depth
  std::int64_t within = 0;    ///< of these, those with an error of at most 1 %
  /// Median of |Z - Z_true| / Z_true over the measured pixels, in steps of 1e-5; errors above 1
  /// count as 1. Nothing when no pixel was measured.
  std::optional<double> median_error;
  /// within / pixels: a pixel without depth counts as wrong. Nothing when there are no pixels.
  std::optional<double> within_1pct;
  std::optional<double> density;  ///< measured / pixels
};

struct DepthScore {
  std::array<DepthAtDistance, kDepthDistances.size()> at{};
  /// Share of the moving pixels seen by both eyes whose depth error is at most 1 %, over the near
  /// frames; a pixel without depth counts as wrong. In a near frame the median true depth of the
  /// moving pixels is 0.12 .. 0.5 m and they cover at least 5 % of the image. Nothing without such
  /// a frame.
  std::optional<double> hand_within_1pct;
  int near_frames = 0;
  /// Share of the pixels with a true depth below 0.11 m, seen by both eyes or not, whose measured
  /// depth exceeds the true one by more than 20 %. Unknown depth and "too close" count as right
  /// here. Nothing when there is no such pixel.
  std::optional<double> too_close_called_far;
  std::int64_t too_close_pixels = 0;
};

/// Accumulates the depth score over frames.
class DepthScorer {
 public:
  /// @param unit  m per count, of all images; > 0
  explicit DepthScorer(double unit);

  /// Adds a frame; all three images have the same size.
  /// @param labels  bits as above. Empty for a truth without labels: then both eyes see every pixel
  ///                and nothing moves
  /// @throws ContractViolation for unequal sizes
  void add(const DepthCounts& truth, const MaskImage& labels, const DepthCounts& found);

  [[nodiscard]] DepthScore score() const;

 private:
  struct Distance {
    std::int64_t pixels = 0;
    std::int64_t measured = 0;
    std::int64_t within = 0;
    std::vector<std::int64_t> errors;  ///< histogram of relative errors, steps of 1e-5
  };

  void add_distances(const DepthCounts& truth, const MaskImage& labels, const DepthCounts& found);
  void add_hand(const DepthCounts& truth, const MaskImage& labels, const DepthCounts& found);

  double unit_;
  std::vector<std::int8_t> distance_of_count_;  ///< (65536) index in kDepthDistances, -1: none
  std::array<Distance, kDepthDistances.size()> distances_;
  std::vector<std::uint16_t> hand_;  ///< true counts of a frame's moving pixels
  std::int64_t hand_pixels_ = 0;
  std::int64_t hand_within_ = 0;
  int near_frames_ = 0;
  std::int64_t too_close_ = 0;
  std::int64_t called_far_ = 0;
};

}  // namespace palpable
