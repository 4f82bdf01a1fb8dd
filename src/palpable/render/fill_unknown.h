/// @file
/// Depth images have holes along every outline (what one eye sees and the other does not, what the
/// matcher refuses). For occlusion a small hole is closed with its nearest known neighbour.
#pragma once

#include "palpable/geometry/image.h"

#include <vector>

namespace palpable {

/// A rectangle of pixels: x0 <= x < x1, y0 <= y < y1.
struct PixelBox {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
  [[nodiscard]] int width() const { return x1 - x0; }
  [[nodiscard]] int height() const { return y1 - y0; }
  [[nodiscard]] bool empty() const { return x1 <= x0 || y1 <= y0; }
};

/// Copies `box` of a depth image; an unknown pixel (NaN, infinite or not positive) becomes the
/// depth of the nearest known pixel of the box within `radius` pixels (Euclidean; of two equally
/// near, the farther depth, because what one eye alone sees is background), or 0 if there is none.
///
/// @param nearest_in_row  workspace, kept between calls so that nothing is allocated
/// @param filled          (box.height x box.width) row-major, overwritten
void fill_unknown(const DepthImage& depth, const PixelBox& box, int radius,
                  std::vector<signed char>& nearest_in_row, std::vector<float>& filled);

}  // namespace palpable
