/// @file
/// From winners to disparities that can be believed: checks, sub-pixel, and filters.
#pragma once

#include "palpable/geometry/image.h"
#include "palpable/stereo/stereo_kernels.h"

#include <cstdint>
#include <vector>

namespace palpable {

/// How well a pixel is known, 0-255: 0 not at all; kFilledConfidence it was filled from its
/// neighbours; else kLeastConfidence and more, the more the better both eyes' codes agree.
inline constexpr std::uint8_t kFilledConfidence = 32;
inline constexpr std::uint8_t kLeastConfidence = 64;

/// Keeps the winners of rows [y_begin, y_end) that the right eye agrees with, and gives them their
/// fraction of a pixel.
///
/// Left-right: of all left pixels that claim the right pixel x - d the one with the smallest S (of
/// equals the nearest) owns it; a winner that is more than `left_right_px` away from the owner's
/// disparity is hidden or wrong. So is one whose partner is outside of the right picture, and one
/// at either end of the range, whose true minimum may lie beyond.
///
/// Fraction: the tip of two lines of equal slope through S(d - 1), S(d), S(d + 1),
///
///     (S(d-1) - S(d+1)) / (2 (max(S(d-1), S(d+1)) - S(d))),   -1/2 .. 1/2
///
/// @param owners  scratch, one per thread
void check_winners(const Winners& winners, int first, int disparities, int left_right_px,
                   int y_begin, int y_end, Disparities& out, GrayImage& confidence,
                   std::vector<std::uint32_t>& owners);

/// Median of 3 x 3 for rows [y_begin, y_end); pixels that are not measured stay so and count as
/// neighbours that agree. The border is copied.
void median_3x3(const Disparities& in, int y_begin, int y_end, Disparities& out);

/// Which patches a SpeckleFilter takes for noise.
struct SpeckleLimits {
  int size = 0;  ///< px; smaller patches
  /// Larger ones too, up to this size, when their mean confidence is below `doubtful_confidence`:
  /// what lies beyond the searched range comes out as patches that hardly agree with the other eye.
  int doubtful_size = 0;
  int doubtful_confidence = 160;
};

/// Makes unknown all 4-connected patches that are noise; within a patch neighbours differ by at
/// most `step`. With doubtful_size 0 this is the answer of cv::filterSpeckles.
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

/// Replaces each measured pixel of rows [y_begin, y_end) by the mean of those of its 5 x 5 window
/// that differ from it by at most kSmoothStep: surfaces become smooth, jumps stay.
inline constexpr int kSmoothStep = kDisparitySteps / 2;
void smooth_surfaces(const Disparities& in, int y_begin, int y_end, Disparities& out);

/// Fills unknown stretches of a row of at most `longest` px: between two ends that differ by at
/// most `step` straight from one to the other; else, if `also_edges`, with the farther end (what a
/// near thing hides belongs to what lies behind it). Sets their confidence to kFilledConfidence.
void fill_gaps(int longest, int step, bool also_edges, int y_begin, int y_end, Disparities& d,
               GrayImage& confidence);

}  // namespace palpable
