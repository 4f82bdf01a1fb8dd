/// @file
/// Both eyes in one image, as UVC stereo cameras send them.
#pragma once

#include "palpable/common/geometry/image.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace palpable {

/// Copies the left half to `left` and the right half to `right`. The last column of an odd
/// width is dropped.
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

/// Whether a picture of this size has the aspect of two eyes: the widest cinema format has a width
/// of 2.4 times the height, two eyes of 4 : 3 side by side have 2.67 times.
[[nodiscard]] inline bool looks_side_by_side(int width, int height) {
  return width % 2 == 0 && width >= 2.5 * height;
}

/// The note about pictures for which that aspect alone decided.
[[nodiscard]] inline std::string guess_of_two_eyes(const std::filesystem::path& picture, int width,
                                                   int height) {
  return fmt::format("{} is {} x {} px, so wide that it is taken for both eyes side by side",
                     picture.string(), width, height);
}

}  // namespace palpable
