/// @file
/// The room frame: Z is up, and the origin is the world's. Viewpoints of pictures from outside are
/// computed in it.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

namespace palpable {

/// rad by which a viewpoint behind a camera is turned to its right, so that the camera does not
/// hide what it looks at.
inline constexpr double kOverTheShoulder = 0.45;

/// A rotation that takes `up` to Z and the world's X (Z where X is nearly up) as near to X as that
/// allows.
/// @param up  world, unit
[[nodiscard]] Rigid3 room_from_world(const Eigen::Vector3d& up);

/// The heading of a camera in the plane of the floor: the azimuth (rad, as OrbitCamera's) of the
/// direction 45 degrees above its optical axis. So the heading of a camera that looks straight down
/// is the direction of the top of its picture.
[[nodiscard]] double heading_of(const Rigid3& room_from_camera);

}  // namespace palpable
