/// @file
/// The first touch of an upright cup that is pushed against a body. Desk frame (desk_body.h), m.
#pragma once

#include <Eigen/Core>

#include <optional>

namespace palpable {

/// A push: its direction, and the contact at its first touch.
struct CupPush {
  Eigen::Vector3d direction;  ///< unit, level
  Eigen::Vector3d at_touch;   ///< the cup's origin (things.h) at the first touch
  Eigen::Vector3d touched;    ///< the point of the body
};

/// The push of a cup along a level direction until its side first touches one of the points; none
/// when the cup passes all of them.
/// @param points  (3 x P), of the body's surface
/// @param aside   m, lateral offset of the cup's axis from the mean of the points
/// @param bottom  m, height of the cup's bottom above the desk
[[nodiscard]] std::optional<CupPush> find_cup_push(const Eigen::Matrix3Xd& points,
                                                   const Eigen::Vector3d& direction, double aside,
                                                   double bottom);

/// rad between the cup's outward normal at the touched point and the ray to the eye.
[[nodiscard]] double view_angle_of_push(const CupPush& push, const Eigen::Vector3d& eye);

}  // namespace palpable
