/// @file
/// Turns the winners of the aggregation into reliable disparities: checks, fractions of a pixel,
/// filters.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/stereo/stereo_kernels.h"

#include <cstdint>
#include <vector>

namespace palpable {

/// Confidence of a pixel, 0-255: 0 unknown; kFilledConfidence filled from its neighbours;
/// kLeastConfidence to 255 matched, higher if the census codes of both images agree better.
inline constexpr std::uint8_t kFilledConfidence = 32;
inline constexpr std::uint8_t kLeastConfidence = 64;

/// Keeps the winners of rows [y_begin, y_end) that are consistent with the right image, and adds
/// their fraction of a pixel.
///
/// Left-right check: several left pixels can match the same right pixel x - d. The one with the
/// smallest S owns it (if several have the same S, the nearest one). A winner that differs from the
/// owner's disparity by more than `left_right_px` is hidden or wrong, and becomes unknown. So does
/// a winner whose partner is outside the right picture, or which is at either end of the range,
/// where the true minimum may lie beyond.
///
/// Fraction: the apex of two lines of equal and opposite slope through S(d - 1), S(d), S(d + 1),
///
///     (S(d-1) - S(d+1)) / (2 (max(S(d-1), S(d+1)) - S(d))),   -1/2 .. 1/2
///
/// @param owners  work space, one per thread
void check_winners(const Winners& winners, int first, int disparities, int left_right_px,
                   int y_begin, int y_end, Disparities& out, GrayImage& confidence,
                   std::vector<std::uint32_t>& owners);

/// Median of 3 x 3 for rows [y_begin, y_end). Pixels that are not measured are not changed; as
/// neighbours they are replaced by the centre. The border is copied.
void median_3x3(const Disparities& in, int y_begin, int y_end, Disparities& out);

/// Limits of the patches that a SpeckleFilter removes as noise.
struct SpeckleLimits {
  int size = 0;  ///< px; smaller patches are removed
  /// px; smaller patches are removed if their mean confidence is below `doubtful_confidence`.
  /// Objects outside the searched range appear as such patches.
  int doubtful_size = 0;
  int doubtful_confidence = 160;
};

/// Sets all 4-connected patches that are noise to unknown; within a patch neighbours differ by at
/// most `step`. With doubtful_size 0 the result is that of cv::filterSpeckles.
class SpeckleFilter {
 public:
  void operator()(const SpeckleLimits& limits, int step, const GrayImage& confidence,
                  Disparities& d);

 private:
  struct Run {
    int begin;
    int end;
    int y;
    int parent;
    int size;
    std::int64_t confidence;  // summed
  };
  int root(int run);
  std::vector<Run> runs_;
};

/// Corrects the lag of disparities on sloping surfaces in rows [y_begin, y_end). On such a surface
/// the disparities along a path of the aggregation lag behind, because each step costs P1. The lags
/// of the paths from the left and from the right cancel, but there is no path from below, so
/// disparities are displaced downwards by about kLagRows_64 / 64 rows. The correction is
///
///     d(x, y) + kLagRows_64 / 64 (d(x, y + 2) - d(x, y - 2)) / 4
///
/// if the three pixels belong to one surface: d(x, y - 2) and d(x, y + 2) differ from d(x, y) by at
/// most kLagStep. On the synthetic desk the lag is 0.98 rows on wood and 0.48 on skin, which after
/// refinement is 0.6 mm of the desk at 0.4 m. On strong texture there is no lag, and refinement
/// removes most of the correction.
inline constexpr int kLagRows_64 = 51;  // 0.8 rows, in 1/64
inline constexpr int kLagStep = 3 * kDisparitySteps / 2;
void take_lag_back(const Disparities& in, int y_begin, int y_end, Disparities& out);

/// Replaces each measured pixel of rows [y_begin, y_end) by the mean of those pixels of its 5 x 5
/// window that differ from it by at most kSmoothStep. This smooths surfaces and preserves jumps.
inline constexpr int kSmoothStep = kDisparitySteps / 2;
void smooth_surfaces(const Disparities& in, int y_begin, int y_end, Disparities& out);

/// Fills gaps of unknown pixels in a row of at most `longest` px. If the two ends differ by at most
/// `step`, the gap is interpolated linearly. Otherwise, with `also_edges`, it is filled with the
/// farther end, because the gap is most often background that a near object hides from one camera.
/// Sets the confidence of filled pixels to kFilledConfidence.
void fill_gaps(int longest, int step, bool also_edges, int y_begin, int y_end, Disparities& d,
               GrayImage& confidence);

}  // namespace palpable
