/// @file
/// Both eyes in one image, as UVC stereo cameras send them.
#pragma once

#include "palpable/common/geometry/image.h"

#include <algorithm>

namespace palpable {

/// The left half to `left`, the right half to `right`. Of an odd width the last column is lost.
inline void split_side_by_side(const ColorImage& both, ColorImage& left, ColorImage& right) {
  const int width = both.width() / 2;
  left.resize(width, both.height());
  right.resize(width, both.height());
  for (int y = 0; y < both.height(); ++y) {
    const Rgb* row = both.row(y);
    std::copy(row, row + width, left.row(y));
    std::copy(row + width, row + 2 * width, right.row(y));
  }
}

/// Whether a picture of this size shows two eyes rather than one, by its aspect: the widest cinema
/// format is 2.4 times as wide as high, two eyes of 4 : 3 are 2.67 times.
[[nodiscard]] inline bool looks_side_by_side(int width, int height) {
  return width % 2 == 0 && width >= 2.5 * height;
}

}  // namespace palpable
