/// @file
/// How far measured depth is from the true one, by distance and on near hands.
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

using LabelImage = Image<std::uint8_t>;

/// Bits of a truth's label.
inline constexpr std::uint8_t kMovingLabel = 1;    ///< hand, sleeve, pencil, cup
inline constexpr std::uint8_t kBothEyesLabel = 2;  ///< the right eye sees the same point

/// The distances at which depth is scored, m. A pixel belongs to one of them when its true depth is
/// within 15 % of it, and else to none.
inline constexpr std::array kDepthDistances{0.2, 0.3, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0};

struct DepthAtDistance {
  std::int64_t pixels = 0;    ///< truly at this distance and seen by both eyes
  std::int64_t measured = 0;  ///< of these, with a depth in the result
  std::int64_t within = 0;    ///< of these, off by at most 1 % of the true depth
  /// Median of |Z - Z_true| / Z_true over the measured ones (to 1e-5; errors above 1 count as 1);
  /// nothing when none was.
  std::optional<double> median_error;
  /// within / pixels: a hole counts as missed. Nothing when there are no pixels.
  std::optional<double> within_1pct;
  std::optional<double> density;  ///< measured / pixels
};

struct DepthScore {
  std::array<DepthAtDistance, kDepthDistances.size()> at{};
  /// Share of the moving pixels that both eyes see whose depth is off by at most 1 %, holes counted
  /// as missed, over the near frames: the median true depth of the moving pixels is 0.12 .. 0.5 m
  /// and they cover at least 5 % of the image. Nothing without such a frame.
  std::optional<double> hand_within_1pct;
  int near_frames = 0;
  /// Share of the pixels truly nearer than 0.11 m, seen by both eyes or not, whose depth in the
  /// result is more than 20 % beyond the true one. Unknown and "too close" are right here. Nothing
  /// when there is no such pixel.
  std::optional<double> too_close_called_far;
  std::int64_t too_close_pixels = 0;
};

/// Adds up frames.
class DepthScorer {
 public:
  /// @param unit  m per count, of all images; > 0
  explicit DepthScorer(double unit);

  /// One frame; all three images of one size.
  /// @param labels  bits as above. An empty image (a truth without labels): both eyes see every
  ///                pixel, nothing moves
  /// @throws ContractViolation for unequal sizes
  void add(const DepthCounts& truth, const LabelImage& labels, const DepthCounts& found);

  [[nodiscard]] DepthScore score() const;

 private:
  struct Distance {
    std::int64_t pixels = 0;
    std::int64_t measured = 0;
    std::int64_t within = 0;
    std::vector<std::int64_t> errors;  ///< histogram of relative errors, steps of 1e-5
  };

  void add_distances(const DepthCounts& truth, const LabelImage& labels, const DepthCounts& found);
  void add_hand(const DepthCounts& truth, const LabelImage& labels, const DepthCounts& found);

  double unit_;
  std::vector<std::int8_t> distance_of_count_;  ///< (65536) index in kDepthDistances, -1 none
  std::array<Distance, kDepthDistances.size()> distances_;
  std::vector<std::uint16_t> hand_;  ///< true counts of a frame's moving pixels
  std::int64_t hand_pixels_ = 0;
  std::int64_t hand_within_ = 0;
  int near_frames_ = 0;
  std::int64_t too_close_ = 0;
  std::int64_t called_far_ = 0;
};

}  // namespace palpable
