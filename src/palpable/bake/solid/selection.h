/// @file
/// Choosing nodes and faces of a body: where it is held and where it is loaded.
///
///   N  nodes     T  triangles of the skin
#pragma once

#include "palpable/common/geometry/tet_mesh.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// Nodes with low <= X <= high in each direction, increasing. Use +-infinity for no limit.
/// @throws Error if there is none
[[nodiscard]] std::vector<int> nodes_in_box(const TetMesh& mesh, const Eigen::Vector3d& low,
                                            const Eigen::Vector3d& high);

/// Nodes within `distance` (m) of the plane through `point`, increasing.
/// @param normal  not zero; its length does not matter
/// @throws Error if there is none, or for a normal of zero
[[nodiscard]] std::vector<int> nodes_on_plane(const TetMesh& mesh, const Eigen::Vector3d& point,
                                              const Eigen::Vector3d& normal, double distance);

/// The node nearest to X (m); of several, the one with the lowest number. @pre there are nodes
[[nodiscard]] int nearest_node(const TetMesh& mesh, const Eigen::Vector3d& X);

/// (3 x T) corner nodes of the body's skin, anticlockwise from outside.
[[nodiscard]] Eigen::Matrix3Xi skin_triangles(const TetMesh& mesh);

/// Those of `triangles` whose three corners are all among `nodes`.
/// @throws Error if there is none
[[nodiscard]] Eigen::Matrix3Xi triangles_between(const Eigen::Matrix3Xi& triangles,
                                                 std::span<const int> nodes);

}  // namespace palpable
