/// @file
/// Rigid transforms, named target_from_source: x_in_world = world_from_camera * x_in_camera.
#pragma once

#include <Eigen/Geometry>

#include <numbers>

namespace palpable {

/// Rotation and translation (m) that maps points of the source frame into the target frame;
/// always named target_from_source.
using Rigid3 = Eigen::Isometry3d;

inline constexpr double kDegree = std::numbers::pi / 180.0;  ///< rad
inline constexpr double kTurn = 2.0 * std::numbers::pi;      ///< rad, a full turn

}  // namespace palpable
