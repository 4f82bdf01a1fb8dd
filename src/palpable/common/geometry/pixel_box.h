/// @file
/// Rectangular parts of an image.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpable {

/// Columns x .. x + width - 1, rows y .. y + height - 1.
struct PixelBox {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  [[nodiscard]] bool contains(int u, int v) const {
    return u >= x && v >= y && u < x + width && v < y + height;
  }
};

/// The part of the image in which a box of space may be visible; without pixels if the box is
/// behind the camera or outside the image, and the whole image if part of the box is behind the
/// camera.
/// @param space  not empty, in the frame from which `camera_from_space` maps
[[nodiscard]] PixelBox box_in_image(const Eigen::AlignedBox3d& space,
                                    const Rigid3& camera_from_space, const PinholeCamera& camera);

/// The smallest box that contains both; a box without pixels is ignored.
[[nodiscard]] PixelBox united(const PixelBox& a, const PixelBox& b);

/// The box enlarged by `margin` px on each side and clipped to the image.
[[nodiscard]] PixelBox grown(const PixelBox& box, int margin, const PinholeCamera& camera);

}  // namespace palpable
