/// @file
/// From the ideal picture, which is painted without a lens, to the raw picture behind the lens.
#pragma once

#include "palpable/common/geometry/camera.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// The ray (x/Z, y/Z) that DistortedCamera::project maps to `pixel`, to 1e-10, by Newton's method.
/// The pixel must lie in the image or slightly outside of it, because far outside a barrel
/// distortion has no inverse.
[[nodiscard]] Eigen::Vector2d undistorted_ray(const DistortedCamera& camera,
                                              const Eigen::Vector2d& pixel);

/// A pinhole camera with the same centre of projection and axis whose picture contains everything
/// that the lens sees. Its principal point is at a whole pixel.
[[nodiscard]] PinholeCamera ideal_camera_for(const DistortedCamera& camera, double focal_px);

/// For each pixel of the raw picture, row by row, the position in the ideal picture, px, from which
/// its light comes.
[[nodiscard]] std::vector<Eigen::Vector2f> distortion_map(const DistortedCamera& camera,
                                                          const PinholeCamera& ideal);

/// Initial values of a depth buffer that keep pixels which the lens does not see from being
/// painted. (ideal.height x ideal.width), row by row:
///
///     1, the farthest   at pixels that a filtered look-up reads, and up to `margin` px round them
///     0, the nearest    elsewhere, where nothing passes the depth test; a fifth of the ideal
///                       picture of a barrel lens
///
/// @param map  result of distortion_map()
[[nodiscard]] std::vector<float> depth_where_seen(const std::vector<Eigen::Vector2f>& map,
                                                  const PinholeCamera& ideal, int margin);

}  // namespace palpable
