/// @file
/// From the ideal picture, which is painted as if there were no lens, to the raw picture of a lens.
#pragma once

#include "palpable/common/geometry/camera.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// The ray (x/Z, y/Z) that DistortedCamera::project maps to `pixel`, to 1e-10, by Newton's method.
/// The pixel must lie in the image or little outside of it: far outside a barrel lens has no
/// inverse.
[[nodiscard]] Eigen::Vector2d undistorted_ray(const DistortedCamera& camera,
                                              const Eigen::Vector2d& pixel);

/// A pinhole camera that sees at least what the lens sees, with the same centre of projection and
/// the same axis. Its principal point is a whole pixel.
[[nodiscard]] PinholeCamera ideal_camera_for(const DistortedCamera& camera, double focal_px);

/// For each pixel of the raw picture, row by row: where in the ideal picture its light comes from,
/// px.
[[nodiscard]] std::vector<Eigen::Vector2f> distortion_map(const DistortedCamera& camera,
                                                          const PinholeCamera& ideal);

/// Depths to begin a depth buffer with, so that nothing is painted where nobody looks.
/// (ideal.height x ideal.width), row by row:
///
///     1, the farthest   at pixels that a filtered look-up reads, and up to `margin` px round them
///     0, the nearest    elsewhere, a fifth of a barrel lens's ideal picture; nothing passes the
///     test
///
/// @param map  of distortion_map()
[[nodiscard]] std::vector<float> depth_where_seen(const std::vector<Eigen::Vector2f>& map,
                                                  const PinholeCamera& ideal, int margin);

}  // namespace palpable
