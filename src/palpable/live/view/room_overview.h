/// @file
/// Finds a viewpoint that shows a whole room, and the room's upward direction.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

#include <span>

namespace palpable {

/// Returns camera_from_world of a viewpoint that shows a whole room: over the shoulder of the
/// camera that moved through it, as near as possible with the points and the whole path in the
/// picture.
/// @param points  (3 x N) world, m; one in fifty on each side of the picture may be left out; N > 0
/// @param path    world_from_camera of the camera that moved through the room; not empty
/// @param up      world, unit
[[nodiscard]] Rigid3 overview(const Eigen::Matrix3Xf& points, std::span<const Rigid3> path,
                              const Eigen::Vector3d& up, const PinholeCamera& camera);

/// Finds the upward direction of a room as the one that most of its surface faces: floors, tables
/// and seats have more area than slanted surfaces.
///
/// Candidates are the upward directions of a camera without roll that is pitched between 60 degrees
/// down and 30 up. Each is moved to the mean of the normals within 20, 15 and then 10 degrees of
/// it; the one with the longest sum of normals is taken.
/// @param normals  (3 x N) world, unit or 0
/// @return world, unit; against the camera's Y axis where no normal is near any candidate
[[nodiscard]] Eigen::Vector3d up_of_room(const Eigen::Matrix3Xf& normals,
                                         const Rigid3& world_from_camera);

}  // namespace palpable
