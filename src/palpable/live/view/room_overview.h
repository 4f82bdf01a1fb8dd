/// @file
/// From where a whole room is seen, and which way is up in it.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

#include <span>

namespace palpable {

/// camera_from_world of an eye that sees a whole room: over the shoulder of the camera that went
/// through it, as near as the points and the whole path allow.
/// @param points  (3 x N) world, m; one in fifty on each side of the picture may be left out; N > 0
/// @param path    world_from_camera of the camera that was there; not empty
/// @param up      world, unit
[[nodiscard]] Rigid3 overview(const Eigen::Matrix3Xf& points, std::span<const Rigid3> path,
                              const Eigen::Vector3d& up, const PinholeCamera& camera);

/// Finds the direction that most of a room's surface faces: floors, tables and seats outnumber what
/// leans.
///
/// Candidates are what a camera held upright and pitched by 60 degrees down to 30 up would call up.
/// Each is moved to the mean of the normals within 20, 15 and then 10 degrees of it; the one with
/// the longest sum of normals wins.
/// @param normals  (3 x N) world, unit or 0
/// @return world, unit; against the camera's Y axis where no normal is near any candidate
[[nodiscard]] Eigen::Vector3d up_of_room(const Eigen::Matrix3Xf& normals,
                                         const Rigid3& world_from_camera);

}  // namespace palpable
