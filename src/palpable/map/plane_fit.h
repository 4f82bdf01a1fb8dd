/// @file
/// The plane on which a body is to stand: a table or a floor in one depth image. Camera frame, m.
#pragma once

#include "palpable/depth/depth_noise.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"

#include <optional>

namespace palpable {

struct PlaneFitSettings {
  double farthest = 1.5;     ///< m of depth; beyond, nobody can reach
  double steepest = 1.2;     ///< rad between the plane's normal and the picture's upward direction
  double least_share = 0.1;  ///< of the picture's known pixels up to `farthest` that must lie in it
  int trials = 150;          ///< of three points each
};

/// normal . x = offset; the normal is a unit vector and looks at the camera's side, so offset < 0.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double offset = 0;                                 ///< m
  double share = 0;                                  ///< of the pixels looked at that lie in it
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< a point of it that was seen, near the
                                                     ///< picture's middle
};

/// The plane with the most pixels that a thing could stand on.
///
/// Random triples vote (Fischler and Bolles 1981, RANSAC; the same ones each time), then eight
/// rounds of weighted least squares: each point's distance along its ray has the depth's sigma, and
/// Tukey's weights leave out what lies beyond 4.685 of them. Looks at a pixel in 16.
/// @return nothing when no plane has the share asked for
[[nodiscard]] std::optional<Plane> fit_standing_plane(const DepthImage& depth,
                                                      const PinholeCamera& camera,
                                                      const DepthNoise& noise,
                                                      const PlaneFitSettings& settings = {});

/// The same plane in another frame.
[[nodiscard]] Plane moved_by(const Rigid3& to_from, const Plane& plane);

/// Where a body stands that is put on the plane at plane.middle: its Z axis along the normal, its X
/// axis as far to the right in the picture as the plane allows.
[[nodiscard]] Rigid3 camera_from_body_on(const Plane& plane);

}  // namespace palpable
