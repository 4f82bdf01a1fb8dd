/// @file
/// The error of measured depth, by distance and on near hands; and how well the depth images along
/// a path agree with one another, which shows whether the poses are accurate enough for a map.
///
/// The depths of DepthScorer are compared as the 16-bit counts of their files
/// (geometry/image.h), in one unit for truth and result.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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
  /// @param labels  bits kMovesLabel and kBothSeeLabel (geometry/image.h). Empty for a truth
  /// without labels: then both eyes see every pixel
  ///                and nothing moves
  /// @throws ContractViolation for unequal sizes
  void add(const DepthCounts& truth, const MaskImage& labels, const DepthCounts& found);

  [[nodiscard]] DepthScore score() const;

 private:
  void add_distances(const DepthCounts& truth, const MaskImage& labels, const DepthCounts& found);
  void add_hand(const DepthCounts& truth, const MaskImage& labels, const DepthCounts& found);

  double unit_;
  std::vector<std::int8_t> distance_of_count_;  ///< (65536) index in kDepthDistances, -1: none
  /// Histograms of the relative errors at each distance, steps of 1e-5.
  std::array<std::vector<std::int64_t>, kDepthDistances.size()> errors_;
  DepthScore counts_;                ///< its numbers of pixels and frames; no share and no median
  std::vector<std::uint16_t> hand_;  ///< true counts of a frame's moving pixels
  std::int64_t hand_pixels_ = 0;
  std::int64_t hand_within_ = 0;
  std::int64_t called_far_ = 0;
};

/// Median difference, m, between the depth of image i transformed into image j by their poses and
/// the depth measured there. The image pairs are 5, 15 and 40 images apart and begin with every
/// sixth image; every eighth pixel in x and y is used. Differences of 0.1 m and more belong to
/// other surfaces and are left out. Nothing when no difference remains.
/// @param depths            (N) images of the camera's size, m
/// @param world_from_depth  (N) poses of the depth camera
/// @throws ContractViolation when the numbers or sizes differ
[[nodiscard]] std::optional<double> warped_disagreement(std::span<const DepthImage> depths,
                                                        std::span<const Rigid3> world_from_depth,
                                                        const PinholeCamera& camera);

}  // namespace palpable
