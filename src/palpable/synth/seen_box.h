/// @file
/// Rectangles of pixels, and the one round what an eye sees of a mover.
#pragma once

#include "palpable/geometry/camera.h"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace palpable {

/// A rectangle of pixels.
struct Box {
  int x = 0, y = 0, width = 0, height = 0;
  [[nodiscard]] Box cut(const Box& other) const {
    const int x0 = std::max(x, other.x);
    const int y0 = std::max(y, other.y);
    return {x0, y0, std::max(0, std::min(x + width, other.x + other.width) - x0),
            std::max(0, std::min(y + height, other.y + other.height) - y0)};
  }
  [[nodiscard]] bool empty() const { return width <= 0 || height <= 0; }
};

/// The smallest rectangle round both.
[[nodiscard]] inline Box around(const Box& a, const Box& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  const int x0 = std::min(a.x, b.x), y0 = std::min(a.y, b.y);
  return {x0, y0, std::max(a.x + a.width, b.x + b.width) - x0,
          std::max(a.y + a.height, b.y + b.height) - y0};
}

/// A picture cut into squares, some of them marked.
struct Tiles {
  int width = 0, height = 0;  ///< px, of the picture
  int size = 1;               ///< px
  std::vector<bool> marked;   ///< row by row

  Tiles(int picture_width, int picture_height, int tile_size)
      : width(picture_width),
        height(picture_height),
        size(tile_size),
        marked(static_cast<std::size_t>(across() * ((height + size - 1) / size)), false) {}
  [[nodiscard]] int across() const { return (width + size - 1) / size; }

  /// Rectangles without overlap that make up the marked squares, or the others.
  [[nodiscard]] std::vector<Box> boxes(bool of_marked) const {
    std::vector<Box> found;
    const int count = static_cast<int>(marked.size());
    for (int t = 0; t < count;) {
      const int row = t / across(), first = t;
      while (t < count && t / across() == row && marked[static_cast<std::size_t>(t)] == of_marked)
        ++t;
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

/// The rectangle round what an eye sees of some capsules: of their parts beyond the near plane.
class SeenBox {
 public:
  static constexpr double kNearest = 0.02;  ///< m, nothing nearer is drawn

  explicit SeenBox(const PinholeCamera& view) : view_(view) {}

  /// The convex hull of two spheres; eye frame, m.
  void include(const Eigen::Vector3d& a, double ra, const Eigen::Vector3d& b, double rb) {
    include(a, ra);
    include(b, rb);
    // Where the near plane cuts it: between the spheres that touch the plane from either side.
    // (What is seen of a convex body is the hull of what is seen of its ends and of this cut.)
    const Eigen::Vector3d ab = b - a;
    for (const double side : {-1.0, 1.0}) {
      const double slope = ab.z() - side * (rb - ra);
      const double along = (kNearest + side * ra - a.z()) / slope;
      if (along > 0.0 && along < 1.0) include(a + along * ab, ra + along * (rb - ra));
    }
  }
  [[nodiscard]] Box pixels() const {
    const auto clamped = [](double value, int limit) {
      return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
    };
    const int x0 = clamped(view_.fx_px * low_.x() + view_.cx_px - kRounding, view_.width);
    const int y0 = clamped(view_.fy_px * low_.y() + view_.cy_px - kRounding, view_.height);
    return {x0, y0, clamped(view_.fx_px * high_.x() + view_.cx_px + kRounding, view_.width) - x0,
            clamped(view_.fy_px * high_.y() + view_.cy_px + kRounding, view_.height) - y0};
  }

 private:
  static constexpr double kRounding = 2.0;  // px, of triangles and pixels
  PinholeCamera view_;
  // Tangents of the rays. Beyond any picture as long as nothing is seen.
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(1e6), high_ = Eigen::Vector2d::Constant(-1e6);

  void include(const Eigen::Vector3d& x, double radius) {
    const double far = x.z() + radius;
    if (far < kNearest - 1e-9) return;  // one that touches the plane counts
    const double near = std::max(kNearest, x.z() - radius);
    for (int axis = 0; axis < 2; ++axis) {
      const double low = x[axis] - radius, high = x[axis] + radius;
      low_[axis] = std::min(low_[axis], low / (low > 0.0 ? far : near));
      high_[axis] = std::max(high_[axis], high / (high > 0.0 ? near : far));
    }
  }
};

}  // namespace palpable
