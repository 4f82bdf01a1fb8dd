/// @file
/// Corners of an image: points that can be found again in other pictures and whose depth is known.
#pragma once

#include "palpable/common/geometry/image.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

struct Corner {
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< px of the full image, integers
  double depth = 0;                              ///< Z, m
  /// Inclination of the surface: d(1/Z) / d(u, v), 1/(m px); 0 where it cannot be measured.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
};

/// Returns the strongest corner (Shi and Tomasi, CVPR 1994) of each cell of the image that contains
/// none of `taken`, the strongest first. The image is divided into 8 x 8 parts, and no part
/// contributes more than about twice its share, so that a single textured object, which may be a
/// hand, cannot contribute all corners.
/// @param half    luma at half of the full size
/// @param depth   m, NaN unknown; of the full or of half the size. No corner is placed where it
///                jumps, because the outline of a near object moves over the background.
/// @param moving  255: no corner there; of the depth's size, or null
/// @param taken   px of the full image: positions of known landmarks
/// @param cells_across  number of cells across the image; cells are square
/// @param most    largest number of corners that are returned
/// @return no corners if OpenCV fails
[[nodiscard]] std::vector<Corner> new_corners(const GrayImage& half, const DepthImage& depth,
                                              const MaskImage* moving,
                                              std::span<const Eigen::Vector2d> taken,
                                              int cells_across, int most);

}  // namespace palpable
