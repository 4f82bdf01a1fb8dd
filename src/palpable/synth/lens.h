/// @file
/// From the ideal picture that is drawn to the raw picture that a lens and a sensor give.
#pragma once

#include "palpable/geometry/camera.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// The ray (x/Z, y/Z) that DistortedCamera::project maps to `pixel`: Newton on the distortion, to
/// 1e-10. The domain is the image and a little around it; far outside a barrel lens has no inverse.
[[nodiscard]] Eigen::Vector2d undistorted_ray(const DistortedCamera& camera,
                                              const Eigen::Vector2d& pixel);

/// A pinhole camera that sees all that the lens sees: the same centre of projection and axis, whole
/// pixels, focal length as given.
[[nodiscard]] PinholeCamera ideal_camera_for(const DistortedCamera& camera, double focal_px);

/// For each pixel of the raw picture, row by row, where in the ideal picture its light comes from
/// (pixels of the ideal picture).
[[nodiscard]] std::vector<Eigen::Vector2f> distortion_map(const DistortedCamera& camera,
                                                          const PinholeCamera& ideal);

/// Depths in 0..1 to begin a depth buffer with, (ideal.height x ideal.width), row by row: 1, the
/// farthest, at pixels of the ideal picture that a filtered look-up of the raw picture reads, and
/// up to `margin` px round them; 0 at those that nobody sees, where a depth test then lets nothing
/// be painted. A fifth of a barrel lens's ideal picture.
/// @param map  of distortion_map
[[nodiscard]] std::vector<float> depth_where_seen(const std::vector<Eigen::Vector2f>& map,
                                                  const PinholeCamera& ideal, int margin);

}  // namespace palpable
