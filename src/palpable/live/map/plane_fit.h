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
  double farthest = 1.5;  ///< m; what lies deeper is out of a hand's reach and is left out
  double steepest = 1.2;  ///< rad at most between the normal and the picture's upward direction
  /// Where no such plane is found the camera may look straight down: then the plane faces it, to
  /// this angle (rad), and has this share. A wall before the camera looks the same.
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
  double share = 0;                                  ///< of the sampled pixels that lie in it
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< of its points that were seen, the one
                                                     ///< nearest to the picture's middle
};

/// Of the planes on which something could stand, the one with the most pixels.
///
/// RANSAC (Fischler and Bolles 1981, with the same random triples each time) finds it, then eight
/// rounds of weighted least squares improve it: each point's distance along its ray has the depth's
/// sigma, and Tukey's weights leave out what lies beyond 4.685 sigma. One pixel in 16 is sampled.
/// @return nothing when no plane has PlaneFitSettings::least_share, nor one that faces the camera
///         share_facing
[[nodiscard]] std::optional<Plane> fit_standing_plane(const DepthImage& depth,
                                                      const PinholeCamera& camera,
                                                      const DepthNoise& noise,
                                                      const PlaneFitSettings& settings = {});

/// The surface at one pixel as a plane: of what was measured within `reach` of the point there, by
/// the same votes and rounds, whatever way it faces. `middle` is that point, `share` of the points
/// around it.
/// @param x_px, y_px  of the depth; may lie beside it
/// @param reach       m, but at least 8 px; what lies deeper than PlaneFitSettings::farthest
/// counts, too
/// @return nothing where no depth is known at the pixel or too little around it, and where the
/// plane
///         around it passes it by
[[nodiscard]] std::optional<Plane> fit_plane_at(const DepthImage& depth,
                                                const PinholeCamera& camera,
                                                const DepthNoise& noise, double x_px, double y_px,
                                                double reach = 0.04);

/// The same plane in another frame: `to` from the frame in which it is given.
[[nodiscard]] Plane moved_by(const Rigid3& to_from, const Plane& plane);

/// The pose of a body that is put on the plane at plane.middle: its Z axis is the normal, its X
/// axis the direction in the plane that runs most to the right in the picture.
[[nodiscard]] Rigid3 camera_from_body_on(const Plane& plane);

}  // namespace palpable
