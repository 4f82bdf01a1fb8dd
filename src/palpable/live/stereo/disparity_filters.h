/// @file
/// From winners to reliable disparities: checks, fractions of a pixel, filters.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/stereo/stereo_kernels.h"

#include <cstdint>
#include <vector>

namespace palpable {

/// Confidence of a pixel, 0-255: 0 unknown; kFilledConfidence filled from its neighbours;
/// kLeastConfidence to 255 matched, the higher the better both eyes' codes agree.
inline constexpr std::uint8_t kFilledConfidence = 32;
inline constexpr std::uint8_t kLeastConfidence = 64;

/// Keeps the winners of rows [y_begin, y_end) that the right eye agrees with, and gives them their
/// fraction of a pixel.
///
/// Left-right: of all left pixels that claim the right pixel x - d the one with the smallest S (of
/// equals the nearest) owns it; a winner that is more than `left_right_px` away from the owner's
/// disparity is hidden or wrong, and becomes unknown. So does one whose partner is outside of the
/// right picture, and one at either end of the range, whose true minimum may lie beyond.
///
/// Fraction: the tip of two lines of equal slope through S(d - 1), S(d), S(d + 1),
///
///     (S(d-1) - S(d+1)) / (2 (max(S(d-1), S(d+1)) - S(d))),   -1/2 .. 1/2
///
/// @param owners  scratch, one per thread
void check_winners(const Winners& winners, int first, int disparities, int left_right_px,
                   int y_begin, int y_end, Disparities& out, GrayImage& confidence,
                   std::vector<std::uint32_t>& owners);

/// Median of 3 x 3 for rows [y_begin, y_end). Pixels that are not measured stay so; as neighbours
/// they count as equal to the centre. The border is copied.
void median_3x3(const Disparities& in, int y_begin, int y_end, Disparities& out);

/// Which patches a SpeckleFilter removes as noise.
struct SpeckleLimits {
  int size = 0;  ///< px; all patches that are smaller
  /// Px; patches smaller than this, too, if their mean confidence is below `doubtful_confidence`:
  /// things beyond the searched range come out as patches that hardly agree with the other eye.
  int doubtful_size = 0;
  int doubtful_confidence = 160;
};

/// Makes unknown all 4-connected patches that are noise; within a patch neighbours differ by at
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

/// A path of the aggregation holds a sloping surface back: a step of a disparity costs P1. From the
/// left and from the right that cancels; no path comes from below, so that disparities come out
/// about kLagRows_64 / 64 rows too late. Takes that back in rows [y_begin, y_end),
///
///     d(x, y) + kLagRows_64 / 64 (d(x, y + 2) - d(x, y - 2)) / 4
///
/// where these three are one surface: neighbours of the sum differ by at most kLagStep. On the
/// synthetic desk the lag is 0.98 rows on wood and 0.48 on skin, after refinement 0.6 mm of the
/// desk at 0.4 m. Where texture is strong there is none, and refinement takes back most of what
/// this adds there.
inline constexpr int kLagRows_64 = 51;  // 0.8 rows, in 1/64
inline constexpr int kLagStep = 3 * kDisparitySteps / 2;
void take_lag_back(const Disparities& in, int y_begin, int y_end, Disparities& out);

/// Replaces each measured pixel of rows [y_begin, y_end) by the mean of those of its 5 x 5 window
/// that differ from it by at most kSmoothStep: surfaces become smooth, jumps stay.
inline constexpr int kSmoothStep = kDisparitySteps / 2;
void smooth_surfaces(const Disparities& in, int y_begin, int y_end, Disparities& out);

/// Fills unknown stretches of a row of at most `longest` px: between two ends that differ by at
/// most `step` linearly from one to the other; else, if `also_edges`, with the farther end, since a
/// near thing hides part of what lies behind it. Sets their confidence to kFilledConfidence.
void fill_gaps(int longest, int step, bool also_edges, int y_begin, int y_end, Disparities& d,
               GrayImage& confidence);

}  // namespace palpable
