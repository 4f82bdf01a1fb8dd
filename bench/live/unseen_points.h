/// @file
/// The side of true things that a camera does not see, as points: what a guess of it is judged by.
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
  /// P: the point lies behind another thing, or another part of its own: on the way to it the
  /// camera's ray comes out of what it has met. The others are the back of what is seen there.
  std::vector<bool> is_behind;
};

/// Points of the capsules' outer surface that the camera does not see: they face away from it, or
/// lie behind other parts of the same things. Only those near a body and inside the picture.
/// @param things   camera frame, m
/// @param reach    m: from the body's surface, outside
/// @param spacing  m, between neighbouring points
[[nodiscard]] UnseenPoints unseen_points(std::span<const Capsule> things,
                                         const PinholeCamera& camera,
                                         const Rigid3& body_from_camera,
                                         const SurfaceDistance& body, double reach, double spacing);

}  // namespace palpable::app
