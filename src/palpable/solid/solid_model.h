/// @file
/// What is to be solved: a body, what it is made of and where it is held (paper eqs. 1-3).
///
///   N  nodes     E  tetrahedra
#pragma once

#include "palpable/geometry/tet_mesh.h"
#include "palpable/solid/material.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

struct SolidModel {
  TetMesh mesh;  ///< undeformed, m
  Material material = NeoHookean{1, 1};
  /// Nodes held in all three directions (the Dirichlet boundary of eq. 3); each once, any order.
  std::vector<int> fixed_nodes;
  /// (3 x fixed_nodes.size()) m, where each held node is taken at load level 1; in between, level
  /// times that. Empty: all stay where they are.
  Eigen::Matrix3Xd fixed_displacement;
};

/// Says what would make every solve fail, before any is tried.
/// @throws Error for: no elements; an index out of range; elements of zero or negative volume
/// (which, how many); nodes that belong to no element; constants of the material out of range;
/// supports that leave the body (or a separate part of it) free to move: fewer than three held
/// nodes or all on one line; a fixed displacement of the wrong size
void check_model(const SolidModel& model);

}  // namespace palpable
