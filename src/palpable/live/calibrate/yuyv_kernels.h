/// @file
/// Warps a camera's YUYV picture: luma and colour of one eye, read where they lie. There is a plain
/// version and one for each set of vector instructions; all give the same bytes.
///
///   w, h  size of the eye's picture and of the warped one, px
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/yuyv.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// Where the pixels of a warped picture lie in the raw one: at every eighth column of each row, and
/// straight between. (The distortion of a lens bends by 0.002 px over 1 px at the most, so that
/// between two of them nothing is off by more than 0.02 px.)
struct WarpGrid {
  static constexpr int kStep = 8;  ///< px
  static constexpr int kOne = 1 << 16;

  /// The eight pixels between two columns, as vectors work on them: what they read of a raw row
  /// lies within 16 px. Filled by prepare().
  struct Step {
    std::int16_t luma_begin = 0;   ///< px
    std::int16_t luma_row = 0;     ///< the first of luma_rows
    std::int16_t color_begin = 0;  ///< pairs of pixels
    std::int16_t color_row = 0;
    std::int8_t luma_rows = 0;   ///< 2 .. 5; 0: they reach farther, or beyond the raw picture
    std::int8_t color_rows = 0;  ///< 1; 0 likewise
  };

  int width = 0;                ///< px, >= 2
  int height = 0;               ///< px, >= 2
  int columns = 0;              ///< beyond the last one, so that each pixel lies between two
  std::vector<std::int32_t> x;  ///< (height x columns) px times kOne; outside of the picture, too
  std::vector<std::int32_t> y;
  std::vector<Step> steps;  ///< (height x columns), the last of each row unused

  void resize(int width_px, int height_px);
  /// @param at_column  a multiple of kStep
  void set(int row, int at_column, double x_px, double y_px);
  /// Once all are set. @param raw_width, raw_height  px, of an eye's raw picture
  void prepare(int raw_width, int raw_height);
};

/// One eye in a picture of both.
struct YuyvEye {
  const Yuyv* first = nullptr;  ///< its first pair of pixels
  std::size_t row_pairs = 0;    ///< pairs from one row of the picture to the next
  int width = 0;                ///< px, of the eye: even, >= 4
  int height = 0;               ///< px, >= 2
};

/// For grids that are prepared for the size of the eye.
struct YuyvKernels {
  const char* name = "";
  /// Bilinear between pixels, in 1/32 px; what lies outside is as the border. BT.601's luma 16 ..
  /// 235 becomes 0 .. 255.
  void (*luma)(const WarpGrid& grid, const YuyvEye& eye, GrayImage& warped);
  /// Colours: those of `luma`, with U and V read once for each two pixels, where their middle lies:
  /// bilinear along the row that is nearest to the middle of their eight.
  /// @param luma  what the function above makes of the same
  void (*color)(const WarpGrid& grid, const YuyvEye& eye, const GrayImage& luma,
                ColorImage& warped);
};

/// All kernels that this processor can run, the fastest first and the plain one last.
[[nodiscard]] std::span<const YuyvKernels> yuyv_kernels();

}  // namespace palpable
