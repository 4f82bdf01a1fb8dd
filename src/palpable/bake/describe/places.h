/// @file
/// From a place in a description to nodes, faces and elements of the mesh.
///
/// Messages begin with the place's own words (file, line, key) and say what to change.
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/mesh/volume_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// Nodes there, increasing. A set of faces stands for its nodes, too.
/// @param volume  placed in the body frame, standing on Z = 0
/// @throws Error if there is none, for an unknown set (with the nearest known one) or one of
///         elements
[[nodiscard]] std::vector<int> nodes_at(const VolumeMesh& volume, const Where& where);

/// Elements whose middles lie there, increasing. @throws Error likewise
[[nodiscard]] std::vector<int> tets_at(const VolumeMesh& volume, const Where& where);

/// (3 x T) faces of the skin all of whose corners lie there, by corner nodes, anticlockwise from
/// outside. Of a set of faces those of the skin. @throws Error likewise
[[nodiscard]] Eigen::Matrix3Xi faces_at(const VolumeMesh& volume, const Where& where);

}  // namespace palpable
