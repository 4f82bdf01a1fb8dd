/// @file
/// Finds the nodes, faces and elements of a mesh at a place that a description gives.
///
/// Messages begin with file, line and key of the place and say what to change.
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/mesh/volume_mesh.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// Where points may lie that stand for the node, or the vertex of the skin, nearest to them.
enum class PointsMayLie { kNearTheSkin, kAlsoInside };

/// Refuses points that lie farther than three mean edges of the skin from it; their unit or frame
/// is probably wrong. @throws Error with the point and its distance
void refuse_far_points(const TetMesh& mesh, std::span<const Eigen::Vector3d> points,
                       PointsMayLie where);

/// Nodes at the place, increasing. A set of faces selects its nodes.
/// @param volume  placed in the body frame, standing on Z = 0
/// @throws Error if there is none, for an unknown set (with the nearest known one) or one of
///         elements, and as refuse_far_points()
[[nodiscard]] std::vector<int> nodes_at(const VolumeMesh& volume, const Where& where);

/// Elements whose middles lie at the place, increasing. @throws Error likewise
[[nodiscard]] std::vector<int> tets_at(const VolumeMesh& volume, const Where& where);

/// (3 x T) faces of the skin all of whose corners lie at the place, by corner nodes, anticlockwise
/// seen from outside. A set of faces selects those of its faces that are on the skin. @throws Error
/// likewise
[[nodiscard]] Eigen::Matrix3Xi faces_at(const VolumeMesh& volume, const Where& where);

}  // namespace palpable
