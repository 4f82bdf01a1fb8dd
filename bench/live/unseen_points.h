/// @file
/// Points on the side of true objects that a camera does not see, by which an assumption about
/// that side is judged.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_distance.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable::app {

struct UnseenPoints {
  Eigen::Matrix3Xd points;  ///< (3 x P) camera frame, m
  /// P: whether the point is behind another thing, or behind another part of its own: the camera's
  /// ray leaves the things before it reaches the point. The other points are on the rear of the
  /// visible surface.
  std::vector<bool> is_behind;
};

/// Points of the capsules' outer surface that the camera does not see, because they face away from
/// it or are behind other parts of the same things. Only points near a body and inside the picture.
/// @param things   camera frame, m
/// @param reach    m, largest distance from the body's surface, outside
/// @param spacing  m, between neighbouring points
[[nodiscard]] UnseenPoints unseen_points(std::span<const Capsule> things,
                                         const PinholeCamera& camera,
                                         const Rigid3& body_from_camera,
                                         const SurfaceDistance& body, double reach, double spacing);

}  // namespace palpable::app
