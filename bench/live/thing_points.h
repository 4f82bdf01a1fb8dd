/// @file
/// Points on the surface of true things, by which a seen surface is judged.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_distance.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable::app {

/// The side of a thing on which a point lies.
enum class Side {
  kFront,  ///< the camera sees it
  kBack,   ///< on the rear of the visible surface
  kBehind  ///< behind another thing, or behind another part of its own: the camera's ray leaves the
           ///< things before it reaches the point
};

struct ThingPoint {
  Eigen::Vector3d x;       ///< m, camera frame
  Eigen::Vector3d normal;  ///< unit, outwards, camera frame
  int thing = -1;          ///< index of the capsule on which it lies
  Side side = Side::kFront;
  bool is_end = false;      ///< on the rounded end of a capsule, such as a fingertip
  bool is_outline = false;  ///< the surface turns away from the camera here: within 9 degrees
};
using ThingPoints = std::vector<ThingPoint>;

/// m; a point is hidden if a ray from the camera meets a thing this far or farther before it.
inline constexpr double kHidden = 5e-4;

/// Points of the capsules' outer surface, near a body and inside the picture.
/// @param things   camera frame, m
/// @param reach    m, largest distance from the body's surface, outside
/// @param spacing  m, between neighbouring points
[[nodiscard]] ThingPoints points_of_things(std::span<const Capsule> things,
                                           const PinholeCamera& camera,
                                           const Rigid3& body_from_camera,
                                           const SurfaceDistance& body, double reach,
                                           double spacing);

}  // namespace palpable::app
