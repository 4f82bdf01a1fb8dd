/// @file
/// The problem that is solved: a body, its materials and its supports (paper eqs. 1-3).
///
///   N  nodes     E  tetrahedra
#pragma once

#include "palpable/common/geometry/tet_mesh.h"
#include "palpable/common/material/material.h"

#include <Eigen/Core>

#include <limits>
#include <vector>

namespace palpable {

/// A node that is held in some directions and free in the others: symmetry planes, sliding faces,
/// plane strain.
struct Support {
  int node;
  Eigen::Array<bool, 3, 1> held;  ///< x, y, z
  /// m, at load level 1 (at other levels: level times that). Read in held directions only.
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
};

/// Elements whose material is not SolidModel::material.
struct MaterialGroup {
  Material material;
  std::vector<int> elements;
};

struct SolidModel {
  TetMesh mesh;                          ///< undeformed, m; 4-node or 10-node tetrahedra
  Material material = NeoHookean{1, 1};  ///< of all elements that are in no group
  /// Nodes held in all three directions (the Dirichlet boundary of eq. 3); each once, any order.
  std::vector<int> fixed_nodes;
  /// (3 x fixed_nodes.size()) m, displacement of each held node at load level 1; at other levels it
  /// is level times that. Empty: all stay where they are.
  Eigen::Matrix3Xd fixed_displacement;
  /// Nodes that are held in some directions only. A node may have several supports, and be in
  /// fixed_nodes as well, if all that hold the same direction give it the same displacement.
  std::vector<Support> supports = {};
  std::vector<MaterialGroup> groups = {};  ///< an element is in one group at most
  /// m, the largest displacement of a node for which the model is meant. A solve that would move a
  /// node farther ends with Stop::kBeyondRange (displacement_range.h).
  double largest_displacement = std::numeric_limits<double>::infinity();
};

/// (E) index into model.groups, -1: model.material.
[[nodiscard]] std::vector<int> material_groups(const SolidModel& model);

/// One direction of one node that is not free.
struct HeldComponent {
  Eigen::Index at;      ///< 3 node + direction
  double displacement;  ///< m, at load level 1
};

/// All that fixed_nodes and supports hold, increasing, each component once.
/// @pre model passed check_model()
[[nodiscard]] std::vector<HeldComponent> held_components(const SolidModel& model);

/// Refuses models whose solves would all fail.
/// @throws Error for: no elements; an index out of range; elements of zero or negative volume
/// (which, how many), or turned inside out by their edge nodes; nodes that belong to no element;
/// constants of a material out of range; groups that overlap; supports that leave the body (or a
/// separate part of it) free to drift or turn; a fixed displacement of the wrong size; supports
/// that contradict each other
void check_model(const SolidModel& model);

}  // namespace palpable
