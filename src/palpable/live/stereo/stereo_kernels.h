/// @file
/// The inner loops of the stereo matcher: a scalar version and a vectorised one that gives the same
/// bytes.
///
///   W, H  width and height of the matched images, px
///   D     disparities searched, a multiple of 16
///
/// **Census** (Zabih and Woodfill 1994): bit n of a pixel's code says whether neighbour n of its
/// 5 x 5 window is darker than the pixel by more than kCensusStep grey levels; 24 bits in three
/// bytes. Codes do not change with exposure or gain.
///
/// **Cost** of disparity d at x: the number of differing bits of left(x) and right(x - first - d),
/// averaged over x-1, x, x+1 with weights 1 2 1 (rounded as avg(avg(c-, c+), c) with
/// avg(a, b) = (a + b + 1) / 2). Beyond the border, the code of the border pixel is used.
///
/// **Aggregation** (semi-global matching, Hirschmueller 2008) along r = from the left, from the
/// right and from above:
///
///     L_r(p, d) = C(p, d) - m + min( L_r(p-r, d), L_r(p-r, d +- 1) + P1, m + P2(p, r) )
///     m         = min_k L_r(p-r, k)
///     P2(p, r)  = max( p2_least, p2 - |I(p) - I(p-r)| )      I: grey levels of the left image
///     S(p, d)   = sum of the three L_r
///
/// P2 is the cost of a jump in depth; it is lower where the picture has an edge. With a constant P2
/// a ramp of P1 steps would be cheaper than the jump from a finger to the desk just behind it, and
/// the position of a touch could not be found in such a ramp. At a path's start L_r = C.
///
/// The picture is divided into kStrips strips of rows. The path from above starts anew kWarmUpRows
/// above each strip, so the strips are independent of each other. They are computed in the lanes of
/// one vector and on several threads, and the result does not depend on the number of these.
///
/// **Fraction of a pixel at full resolution**: at disparity d of an image of half the size, the
/// difference of the full images in a window of 8 x 6 px around (2x, 2y) is r(u) = L(u) - R(u -
/// 2d), where R is interpolated along the row. With g = dL/du the window matches best (Lucas and
/// Kanade 1981; the images may differ by a constant) after a step of
///
///     -cov(g, r) / (var(g) + kFlatness)       full pixels
///
/// which is limited to kLongestStep, because longer steps are caused by edges and highlights.
#pragma once

#include "palpable/common/geometry/image.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace palpable {

inline constexpr int kStrips = 8;
inline constexpr int kWarmUpRows = 8;
inline constexpr int kCensusStep = 1;
/// Largest P2. Costs are at most 24, so that with this P2 the sum of three paths fits a byte.
inline constexpr int kLargestP2 = 61;
/// Largest magnitude of a disparity: disparities and their differences fit 16 bits.
inline constexpr int kMostDisparities = 496;

inline constexpr int kDisparitySteps = 64;  ///< disparities are integers in units of 1/64 px

using Disparities = Image<std::int16_t>;
inline constexpr std::int16_t kUnknownDisparity = INT16_MIN;
inline constexpr std::int16_t kTooCloseDisparity = INT16_MAX;
[[nodiscard]] constexpr bool is_measured(std::int16_t d) {
  return d != kUnknownDisparity && d != kTooCloseDisparity;
}

/// The three bytes of the pixels' census codes, each in an image of its own (H x W).
using CensusCodes = std::array<GrayImage, 3>;

/// The result of the aggregation for each pixel (H x W each).
struct Winners {
  Image<std::uint16_t> best;  ///< the smallest d for which S is smallest
  GrayImage cost;             ///< S(best)
  GrayImage before;           ///< S(best - 1), 255 if there is none
  GrayImage after;            ///< S(best + 1), 255 if there is none

  void resize(int width, int height);
};

/// Costs along a path, in bits of the census code: P1 for a step of one disparity, P2 for a jump.
struct PathPenalties {
  int p1 = 0;
  int p2 = 0;        ///< <= kLargestP2
  int p2_least = 0;  ///< p1 <= p2_least <= p2

  /// P2 between two pixels whose grey levels differ by `difference`.
  [[nodiscard]] std::uint8_t p2_across(int difference) const {
    const int fallen = p2 - (difference < 0 ? -difference : difference);
    return static_cast<std::uint8_t>(fallen > p2_least ? fallen : p2_least);
  }
  [[nodiscard]] bool are_sound() const {
    return 0 <= p1 && p1 <= p2_least && p2_least <= p2 && p2 <= kLargestP2;
  }
};

struct MatchJob {
  const CensusCodes* left = nullptr;
  const CensusCodes* right = nullptr;
  const GrayImage* image = nullptr;  ///< the left one
  int first = 0;                     ///< px, may be negative
  int disparities = 0;               ///< D
  PathPenalties penalties;
  Winners* winners = nullptr;
};

/// One implementation of the loops.
struct StereoKernels {
  const char* name;  ///< "scalar", "SSE4", "AVX2", "AVX3" (AVX-512), "AVX3_DL" (with byte popcount)
  /// Codes of a whole image; `codes` has its size already. Workspace as below.
  void (*census)(const GrayImage& image, CensusCodes& codes, std::uint8_t* workspace);
  /// Computes the winners in the rows of strips first_strip .. first_strip + count - 1 only.
  /// @param workspace  kernel_workspace_bytes() of memory, aligned to 64 bytes; one per thread
  void (*match)(const MatchJob& job, int first_strip, int count, std::uint8_t* workspace);
  /// Refines the measured disparities of rows [y_begin, y_end) of an image of half the size so that
  /// the full images match best. Pixels whose window extends beyond a picture are not changed.
  void (*refine)(const GrayImage& left, const GrayImage& right, int y_begin, int y_end,
                 Disparities& d, std::uint8_t* workspace);
  /// median_3x3 and smooth_surfaces of disparity_filters.h.
  void (*median)(const Disparities& in, int y_begin, int y_end, Disparities& out);
  void (*smooth)(const Disparities& in, int y_begin, int y_end, Disparities& out);
};

/// Sums over a pixel's window in `refine`: g = L(u+1) - L(u-1), r in 1/64 grey levels.
struct RefineSums {
  std::int64_t g = 0, r = 0, gg = 0, gr = 0;

  /// The step in 1/64 px of the half image.
  [[nodiscard]] int step() const;
};
inline constexpr int kRefineColumns = 8;  // columns of the window, from 2x - 3 on
inline constexpr int kRefineRows = 6;     // rows of the window, from 2y - 2 on

/// Regularisation, (grey levels per pixel)^2: in a window whose gradient has this variance the step
/// is halved.
inline constexpr int kFlatness = 16;
inline constexpr int kLongestStep =
    16;  ///< 1/64 px of the half image: half a pixel of the full one

/// The window of pixel (x, y) of the half image in both full images.
struct RefineWindow {
  constexpr RefineWindow(int x, int y, std::int16_t d, int width, int height)
      : left(2 * x - 3), top(top_of(y)) {
    const int shift = 2 * d;  // 1/64 full px
    const int whole = (shift + kDisparitySteps - 1) >> 6;
    static_assert(kDisparitySteps == 64);
    right = left - whole;
    fraction = whole * kDisparitySteps - shift;
    // L needs one more column on each side for the gradient, R one on the right to interpolate.
    inside = left >= 1 && left + kRefineColumns < width && right >= 0 &&
             right + kRefineColumns < width && top >= 0 && top + kRefineRows <= height;
  }
  [[nodiscard]] static constexpr int top_of(int y) { return 2 * y - 2; }
  bool inside = false;  ///< false: it extends beyond a picture
  int left;             ///< first column of L
  int right = 0;        ///< first column of R
  int top;              ///< first row
  int fraction = 0;     ///< weight of R(u + 1), 1/64
};

/// The workspace that census, match and refine need for matched images of this width.
[[nodiscard]] std::size_t kernel_workspace_bytes(int width, int disparities);

/// Rows [begin, end) of strip s.
struct StripRows {
  int begin;
  int end;
};
[[nodiscard]] constexpr StripRows rows_of_strip(int strip, int height) {
  return {strip * height / kStrips, (strip + 1) * height / kStrips};
}

/// The straightforward, slow implementation.
[[nodiscard]] const StereoKernels& scalar_stereo_kernels();
/// All implementations that this processor can run, best first; the last is the scalar one.
[[nodiscard]] std::span<const StereoKernels> stereo_kernels();

}  // namespace palpable
