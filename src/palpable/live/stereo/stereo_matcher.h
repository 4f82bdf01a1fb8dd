/// @file
/// Dense disparities of a rectified pair on a CPU, also at the short distances of a touch (paper
/// Sec. 3.3).
///
/// The method consists of census codes, semi-global aggregation (stereo_kernels.h), a left-right
/// check and filters (disparity_filters.h), and a guard. Without the guard, an object nearer than
/// the searched range would not leave a hole but be matched wrongly, at a large depth. So a second
/// pass at a quarter of the resolution, over a range several times as long, marks such pixels.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/stereo/disparity_filters.h"
#include "palpable/live/stereo/stereo_kernels.h"

#include <memory>

namespace palpable {

struct StereoMatcherSettings {
  int first = 0;          ///< smallest disparity, px; may be negative
  int disparities = 128;  ///< number searched; rounded up to a multiple of 16; with |first| at most
                          ///< kMostDisparities - 1
  PathPenalties penalties{3, 40, 40};
  int left_right_px = 2;  ///< largest difference in the left-right check
  SpeckleLimits speckles{100, 0};
  int longest_gap_px = 8;   ///< gaps in a row up to this length are filled from their ends
  bool fill_edges = false;  ///< also fill gaps between near and far, with the farther disparity
  /// Number of disparities of the guard, at a quarter of the resolution; 0: no guard.
  int guard_disparities = 0;
  int threads = 2;
  const StereoKernels* kernels = nullptr;  ///< null: the fastest for this processor
};

/// Settings for objects within reach, at half the resolution of a 720p pair: 192 disparities, with
/// a guard.
[[nodiscard]] StereoMatcherSettings near_matching();
/// Settings for scenes and benchmarks, at full resolution: 128 disparities, gaps filled.
[[nodiscard]] StereoMatcherSettings full_matching();

/// (H x W) each.
struct MatchedPair {
  Disparities disparity;  ///< of the left image, 1/kDisparitySteps px; unknown; too close
  GrayImage confidence;   ///< disparity_filters.h
};

/// Allocates memory in its constructor and at the first pair of a size, afterwards none.
/// Disparities depend neither on the number of threads nor on the instruction set.
class StereoMatcher {
 public:
  /// @throws ContractViolation unless 0 <= p1 <= p2_least <= p2 <= kLargestP2, 1 <= disparities and
  /// first + disparities fit kMostDisparities, threads >= 1
  explicit StereoMatcher(const StereoMatcherSettings& settings);
  StereoMatcher(StereoMatcher&&) noexcept;
  StereoMatcher& operator=(StereoMatcher&&) noexcept;
  ~StereoMatcher();

  /// @throws ContractViolation when the images differ in size or are smaller than 16 x 16
  void match(const GrayImage& left, const GrayImage& right, MatchedPair& out);

  /// Refines disparities of images of half the size with the full images: corrects their lag
  /// (take_lag_back), refines, and smooths them. Compared with matching without refinement, this
  /// halves the error for a fifth of the time.
  /// @throws ContractViolation unless the images are twice as large as the pair, or larger than
  ///         that by one pixel
  void refine(const GrayImage& left_full, const GrayImage& right_full, MatchedPair& pair);

  [[nodiscard]] const StereoMatcherSettings& settings() const;
  /// Name of the instruction set in use.
  [[nodiscard]] const char* simd() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable
