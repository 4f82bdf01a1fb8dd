/// @file
/// Places of an image that can be followed and whose depth is known.
#pragma once

#include "palpable/geometry/image.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

struct Corner {
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< px of the full image, whole numbers
  double depth = 0;                              ///< Z, m
  /// d(1/Z) / d(u, v), 1/(m px): how the surface is inclined; 0 where that is not known.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
};

/// The strongest corner (Shi and Tomasi, CVPR 1994) in each cell that holds none of `taken`, the
/// strongest first, not more than a few from the same eighth of the image.
/// @param half    luma at half of the full size
/// @param depth   m, NaN unknown; of the full or of half the size. No corner where it jumps.
/// @param moving  255: no corner there; of the depth's size, or null
/// @param taken   px of the full image
/// @param cells_across  of the image
/// @param most    that are given
/// Nothing when OpenCV fails.
[[nodiscard]] std::vector<Corner> new_corners(const GrayImage& half, const DepthImage& depth,
                                              const MaskImage* moving,
                                              std::span<const Eigen::Vector2d> taken,
                                              int cells_across, int most);

}  // namespace palpable
