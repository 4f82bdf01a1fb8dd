/// @file
/// The plane on which a body is to stand: a table or a floor in one depth image. Camera frame, m.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/depth/depth_noise.h"

#include <optional>

namespace palpable {

struct PlaneFitSettings {
  double farthest = 1.5;  ///< m; greater depths are left out, because they are beyond reach
  double steepest = 1.2;  ///< rad at most between the normal and the picture's upward direction
  /// If no such plane is found, the camera may be looking straight down. Then a plane is accepted
  /// whose normal points to the camera within this angle (rad) and that has this share of the
  /// pixels. A wall in front of the camera cannot be distinguished from that.
  double facing = 0.4;
  double share_facing = 0.5;
  double least_share =
      0.1;           ///< share of the pixels with a depth up to `farthest` that must lie in it
  int trials = 150;  ///< planes through three random points each that are tried
};

/// normal . x = offset. The normal is a unit vector towards the camera's side, so offset < 0.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double offset = 0;                                 ///< m
  double share = 0;                                  ///< share of the samples that lie in it
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< its measured point that is nearest to
                                                     ///< the picture's middle
};

/// Finds the plane with the most pixels among those on which something could stand.
///
/// RANSAC (Fischler and Bolles 1981, with the same random triples each time) finds it, then eight
/// rounds of weighted least squares improve it: the residual of a point is its distance from the
/// plane along its ray, divided by the depth's sigma, and Tukey's weights leave out points beyond
/// 4.685 sigma. One pixel in 16 is sampled.
/// @return nothing if neither a standing plane reaches PlaneFitSettings::least_share nor a plane
///         that faces the camera share_facing
[[nodiscard]] std::optional<Plane> fit_standing_plane(const DepthImage& depth,
                                                      const PinholeCamera& camera,
                                                      const DepthNoise& noise,
                                                      const PlaneFitSettings& settings = {});

/// Fits a plane of any orientation to the surface at one pixel, from the points that were measured
/// within `reach` of the point there, by the same method as fit_standing_plane(). In the result,
/// `middle` is the plane's point on the pixel's ray and `share` refers to the points used.
/// @param x_px, y_px  in the depth image; may lie outside
/// @param reach       m, but at least 8 px; PlaneFitSettings::farthest does not apply
/// @return nothing if no depth is known at the pixel, if too few are known around it, or if the
///         plane misses the measured point by more than half the reach
[[nodiscard]] std::optional<Plane> fit_plane_at(const DepthImage& depth,
                                                const PinholeCamera& camera,
                                                const DepthNoise& noise, double x_px, double y_px,
                                                double reach = 0.04);

/// The same plane in another frame of reference, `to`.
[[nodiscard]] Plane moved_by(const Rigid3& to_from, const Plane& plane);

/// The pose of a body that is put on the plane at plane.middle: its Z axis is the normal, its X
/// axis the direction in the plane that points most to the right in the picture.
[[nodiscard]] Rigid3 camera_from_body_on(const Plane& plane);

}  // namespace palpable
