/// @file
/// Warps a camera's YUYV picture without converting it first: luma and colour of one eye. There is
/// a scalar version and one for each set of vector instructions; all give the same bytes.
///
///   w, h  size of the eye's picture and of the warped one, px
#pragma once

#include "palpable/common/geometry/image.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// A warped (rectified) picture takes each of its pixels from a position in the raw picture of the
/// camera. These positions are stored for every eighth column of each row and interpolated linearly
/// between. (The second derivative of a lens's distortion is at most 0.002 px per
/// px^2, so the error of the interpolation is at most 0.02 px.)
struct WarpGrid {
  static constexpr int kStep = 8;  ///< px
  static constexpr int kOne = 1 << 16;

  /// The part of the raw picture that a vector step needs, which computes the eight pixels between
  /// two stored columns: 16 px of some rows. Filled by prepare().
  struct Step {
    std::int16_t luma_begin = 0;   ///< px
    std::int16_t luma_row = 0;     ///< the first row
    std::int16_t color_begin = 0;  ///< pairs of pixels
    std::int16_t color_row = 0;
    std::int8_t luma_rows = 0;   ///< number of rows, 2 .. 5; 0: the step needs more than this part,
                                 ///< or pixels outside the raw picture
    std::int8_t color_rows = 0;  ///< 1; or 0 for the same reasons
  };

  int width = 0;                ///< px, >= 2
  int height = 0;               ///< px, >= 2
  int columns = 0;              ///< stored columns; each pixel lies between two
  std::vector<std::int32_t> x;  ///< (height x columns) px times kOne; may be outside the picture
  std::vector<std::int32_t> y;
  std::vector<Step> steps;  ///< (height x columns), the last of each row unused

  void resize(int width_px, int height_px);
  /// @param at_column  a multiple of kStep
  void set(int row, int at_column, double x_px, double y_px);
  /// Must be called after all positions are set.
  /// @param raw_width, raw_height  px, of an eye's raw picture
  void prepare(int raw_width, int raw_height);
};

/// The part of one eye in a picture of both.
struct YuyvEye {
  const Yuyv* first = nullptr;  ///< its first pair of pixels
  std::size_t row_pairs = 0;    ///< pairs from one row of the picture to the next
  int width = 0;                ///< px, of the eye: even, >= 4
  int height = 0;               ///< px, >= 2
};

/// One implementation of the loops. Grids must be prepared for the size of the eye.
struct YuyvKernels {
  const char* name = "";
  /// Bilinear interpolation in steps of 1/32 px; outside the picture the border's value is used.
  /// BT.601's luma 16 .. 235 is scaled to 0 .. 255.
  void (*luma)(const WarpGrid& grid, const YuyvEye& eye, GrayImage& warped);
  /// Computes colours from `luma` and from U and V, which are sampled once for each two pixels, at
  /// their middle: interpolated linearly along one row, the one nearest to the middle of the step.
  /// @param luma  the result of the function above for the same eye
  void (*color)(const WarpGrid& grid, const YuyvEye& eye, const GrayImage& luma,
                ColorImage& warped);
};

/// All kernels that this processor can run, the fastest first and the scalar one last.
[[nodiscard]] std::span<const YuyvKernels> yuyv_kernels();

}  // namespace palpable
