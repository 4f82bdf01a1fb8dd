/// @file
/// Rigid transforms. Names say the way: x_in_world = world_from_camera * x_in_camera.
#pragma once

#include <Eigen/Geometry>

namespace palpable {

/// Rotation and translation (m) that maps points of the source frame into the target frame;
/// always named target_from_source.
using Rigid3 = Eigen::Isometry3d;

}  // namespace palpable
