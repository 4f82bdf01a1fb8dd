/// @file
/// Tiles of a picture.
#pragma once

#include "palpable/common/geometry/pixel_box.h"

#include <algorithm>
#include <vector>

namespace palpable {

/// A picture divided into square tiles (cut off at its right and lower border), some of them
/// marked.
struct Tiles {
  int width = 0, height = 0;  ///< px, of the picture
  int size = 1;               ///< px
  std::vector<bool> marked;   ///< row by row

  Tiles(int picture_width, int picture_height, int tile_size)
      : width(picture_width),
        height(picture_height),
        size(tile_size),
        marked(across() * ((height + size - 1) / size), false) {}
  [[nodiscard]] int across() const { return (width + size - 1) / size; }

  /// Rectangles that do not overlap and together cover exactly the marked tiles, or exactly the
  /// others.
  [[nodiscard]] std::vector<PixelBox> boxes(bool of_marked) const {
    std::vector<PixelBox> found;
    const int count = static_cast<int>(marked.size());
    for (int t = 0; t < count;) {
      const int row = t / across(), first = t;
      while (t < count && t / across() == row && marked[t] == of_marked) ++t;
      if (t == first) {
        ++t;
        continue;
      }
      const PixelBox run =
          PixelBox{(first - row * across()) * size, row * size, (t - first) * size, size}.cut(
              {0, 0, width, height});
      const auto above = std::find_if(found.begin(), found.end(), [&](const PixelBox& b) {
        return b.x == run.x && b.width == run.width && b.y + b.height == run.y;
      });
      if (above == found.end())
        found.push_back(run);
      else
        above->height += run.height;
    }
    return found;
  }
};

}  // namespace palpable
