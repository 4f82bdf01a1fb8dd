/// @file
/// Corners of an image: places that can be found again, and whose depth is known.
#pragma once

#include "palpable/common/geometry/image.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

struct Corner {
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< px of the full image, whole numbers
  double depth = 0;                              ///< Z, m
  /// d(1/Z) / d(u, v), 1/(m px): how the surface is inclined; 0 where that cannot be measured.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
};

/// The strongest corner (Shi and Tomasi, CVPR 1994) of each cell of the image that holds none of
/// `taken`, the strongest first. The image is cut into 8 x 8 parts, and no part gives more than
/// twice its share: a single textured thing, which may be a hand, cannot take all.
/// @param half    luma at half of the full size
/// @param depth   m, NaN unknown; of the full or of half the size. Where it jumps there is no
///                corner: a near thing's outline before the background moves over it.
/// @param moving  255: no corner there; of the depth's size, or null
/// @param taken   px of the full image: landmarks that are known already
/// @param cells_across  of the image; cells are square
/// @param most    corners that are returned
/// @return nothing when OpenCV fails
[[nodiscard]] std::vector<Corner> new_corners(const GrayImage& half, const DepthImage& depth,
                                              const MaskImage* moving,
                                              std::span<const Eigen::Vector2d> taken,
                                              int cells_across, int most);

}  // namespace palpable
