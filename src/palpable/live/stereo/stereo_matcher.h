/// @file
/// Dense disparities of a rectified pair, down to touching distance, on a CPU (paper Sec. 3.3).
///
/// Census codes, semi-global aggregation (stereo_kernels.h), left-right check and filters
/// (disparity_filters.h), and a guard. Without the guard a thing that is nearer than the searched
/// range would not leave a hole: it would be matched wrongly and come out far away. So a second
/// pass at a quarter of the resolution, over a range several times as long, marks such places.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/stereo/disparity_filters.h"
#include "palpable/live/stereo/stereo_kernels.h"

#include <memory>

namespace palpable {

struct StereoMatcherSettings {
  int first = 0;          ///< smallest disparity, px; may be negative
  int disparities = 128;  ///< how many; rounded up to a multiple of 16; at most kMostDisparities
  PathPenalties penalties{3, 40, 40};
  int left_right_px = 2;  ///< by how much the disparities of both eyes may differ
  SpeckleLimits speckles{100, 0};
  int longest_gap_px = 8;   ///< gaps of a row up to this length are filled from their ends
  bool fill_edges = false;  ///< also gaps between near and far, with the far end's disparity
  /// Disparities of the guard at a quarter of the resolution; 0: no guard.
  int guard_disparities = 0;
  int threads = 2;
  const StereoKernels* kernels = nullptr;  ///< null: the best of this processor
};

/// For things within reach, at half the resolution of a 720p pair: 192 disparities, with a guard.
[[nodiscard]] StereoMatcherSettings near_matching();
/// For scenes and benchmarks, at full resolution: 128 disparities, gaps filled.
[[nodiscard]] StereoMatcherSettings full_matching();

/// (H x W) each.
struct MatchedPair {
  Disparities disparity;  ///< of the left image, 1/kDisparitySteps px; unknown; too close
  GrayImage confidence;   ///< disparity_filters.h
};

/// Allocates memory while it is made and at the first pair of a size, then none.
/// Disparities do not depend on the number of threads nor on the instruction set.
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

  /// Brings disparities of images of half the size to the precision of the full ones, and smooths
  /// them, after their lag (take_lag_back) is taken back: half the error for a fifth of the time.
  /// @throws ContractViolation unless the images are twice as large as the pair, or by a pixel more
  void refine(const GrayImage& left_full, const GrayImage& right_full, MatchedPair& pair);

  [[nodiscard]] const StereoMatcherSettings& settings() const;
  /// Name of the instruction set that it runs on.
  [[nodiscard]] const char* simd() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable
