/// @file
/// The room frame: Z up, the origin where the world's is. Pictures from outside are led in it.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

namespace palpable {

/// rad by which an eye behind a camera stands to its right, so that the camera does not hide what
/// it looks at.
inline constexpr double kOverTheShoulder = 0.45;

/// A rotation that takes `up` to Z and the world's X (Z where X is nearly up) as near to X as that
/// allows.
/// @param up  world, unit
[[nodiscard]] Rigid3 room_from_world(const Eigen::Vector3d& up);

/// Where a camera heads in the plane of the floor: the azimuth (rad, OrbitCamera's) of the
/// direction 45 degrees above its optical axis. A camera that looks straight down so heads where
/// the top of its picture points.
[[nodiscard]] double heading_of(const Rigid3& room_from_camera);

}  // namespace palpable
