/// @file
/// Rectangles and tiles of pixels.
#pragma once

#include <algorithm>
#include <vector>

namespace palpable {

/// A rectangle of pixels.
struct Box {
  int x = 0, y = 0, width = 0, height = 0;
  /// The intersection, which may be empty().
  [[nodiscard]] Box cut(const Box& other) const {
    const int x0 = std::max(x, other.x);
    const int y0 = std::max(y, other.y);
    return {x0, y0, std::max(0, std::min(x + width, other.x + other.width) - x0),
            std::max(0, std::min(y + height, other.y + other.height) - y0)};
  }
  [[nodiscard]] bool empty() const { return width <= 0 || height <= 0; }
};

/// The smallest rectangle that contains both.
[[nodiscard]] inline Box around(const Box& a, const Box& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  const int x0 = std::min(a.x, b.x), y0 = std::min(a.y, b.y);
  return {x0, y0, std::max(a.x + a.width, b.x + b.width) - x0,
          std::max(a.y + a.height, b.y + b.height) - y0};
}

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
  [[nodiscard]] std::vector<Box> boxes(bool of_marked) const {
    std::vector<Box> found;
    const int count = static_cast<int>(marked.size());
    for (int t = 0; t < count;) {
      const int row = t / across(), first = t;
      while (t < count && t / across() == row && marked[t] == of_marked) ++t;
      if (t == first) {
        ++t;
        continue;
      }
      const Box run =
          Box{(first - row * across()) * size, row * size, (t - first) * size, size}.cut(
              {0, 0, width, height});
      const auto above = std::find_if(found.begin(), found.end(), [&](const Box& b) {
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
