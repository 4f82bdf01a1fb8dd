/// @file
/// Rectangular parts of an image.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>

namespace palpable {

/// Columns x .. x + width - 1, rows y .. y + height - 1.
struct PixelBox {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  /// Columns left .. right - 1, rows top .. bottom - 1.
  [[nodiscard]] static constexpr PixelBox between(int left, int top, int right, int bottom) {
    return {left, top, right - left, bottom - top};
  }
  [[nodiscard]] constexpr int right() const { return x + width; }    ///< one behind the last column
  [[nodiscard]] constexpr int bottom() const { return y + height; }  ///< one behind the last row
  [[nodiscard]] constexpr bool empty() const { return width <= 0 || height <= 0; }
  [[nodiscard]] bool contains(int u, int v) const {
    return u >= x && v >= y && u < right() && v < bottom();
  }
  /// The intersection, which may be empty().
  [[nodiscard]] PixelBox cut(const PixelBox& other) const {
    const int left = std::max(x, other.x), top = std::max(y, other.y);
    return {left, top, std::max(0, std::min(right(), other.right()) - left),
            std::max(0, std::min(bottom(), other.bottom()) - top)};
  }
};

/// The smallest box that contains both; a box without pixels is ignored.
[[nodiscard]] inline PixelBox united(const PixelBox& a, const PixelBox& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return PixelBox::between(std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.right(), b.right()),
                           std::max(a.bottom(), b.bottom()));
}

/// The part of the image in which a box of space may be visible; without pixels if the box is
/// behind the camera or outside the image, and the whole image if part of the box is behind the
/// camera.
/// @param space  not empty, in the frame from which `camera_from_space` maps
[[nodiscard]] PixelBox box_in_image(const Eigen::AlignedBox3d& space,
                                    const Rigid3& camera_from_space, const PinholeCamera& camera);

/// The box enlarged by `margin` px on each side and clipped to the image.
[[nodiscard]] PixelBox grown(const PixelBox& box, int margin, const PinholeCamera& camera);

}  // namespace palpable
