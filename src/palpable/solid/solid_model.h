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

/// A node that is held in some directions and free in the others: symmetry planes, sliding faces,
/// plane strain.
struct Support {
  int node;
  Eigen::Array<bool, 3, 1> held;  ///< x, y, z
  /// m, at load level 1 (in between, level times that); read where held.
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
};

struct SolidModel {
  TetMesh mesh;  ///< undeformed, m
  Material material = NeoHookean{1, 1};
  /// Nodes held in all three directions (the Dirichlet boundary of eq. 3); each once, any order.
  std::vector<int> fixed_nodes;
  /// (3 x fixed_nodes.size()) m, where each held node is taken at load level 1; in between, level
  /// times that. Empty: all stay where they are.
  Eigen::Matrix3Xd fixed_displacement;
  /// Further holds, direction by direction. A node may be in several, and in fixed_nodes as well,
  /// as long as they agree where they hold the same direction.
  std::vector<Support> supports = {};
};

/// One direction of one node that is not free.
struct HeldComponent {
  Eigen::Index at;      ///< 3 node + direction
  double displacement;  ///< m, at load level 1
};

/// All that fixed_nodes and supports hold, increasing, each component once.
/// @pre model passed check_model()
[[nodiscard]] std::vector<HeldComponent> held_components(const SolidModel& model);

/// Says what would make every solve fail, before any is tried.
/// @throws Error for: no elements; an index out of range; elements of zero or negative volume
/// (which, how many); nodes that belong to no element; constants of the material out of range;
/// supports that leave the body (or a separate part of it) free to drift or turn; a fixed
/// displacement of the wrong size; supports that contradict each other
void check_model(const SolidModel& model);

}  // namespace palpable
