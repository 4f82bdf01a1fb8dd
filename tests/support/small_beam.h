/// @file
/// A cantilever small enough for tests: 0.40 x 0.10 x 0.05 m, clamped at x = 0.
#pragma once

#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/solid_model.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <cmath>
#include <vector>

namespace palpable::test {

inline SolidModel small_beam(int nx = 16, int ny = 4, int nz = 2) {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {0.40, 0.10, 0.05}, nx, ny, nz);
  model.material = material_from_young("saint-venant-kirchhoff", 0.5e6, 0.3);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(0, n) == 0.0) model.fixed_nodes.push_back(n);
  }
  return model;
}

/// Nodes of the face Z = height with x >= `from`.
inline std::vector<int> face_nodes(const SolidModel& model, double height, double from) {
  std::vector<int> nodes;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (std::abs(model.mesh.nodes(2, n) - height) < 1e-9 && model.mesh.nodes(0, n) >= from) {
      nodes.push_back(n);
    }
  }
  return nodes;
}

/// (3N x S): column s is a force of `force` N along z at node s, distributed over the face's
/// nodes within 0.035 m.
inline Eigen::SparseMatrix<double> face_loads(const SolidModel& model,
                                              const std::vector<int>& nodes, double force) {
  const Eigen::Matrix3Xd& X = model.mesh.nodes;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    std::vector<int> patch;
    for (int n = 0; n < model.mesh.node_count(); ++n) {
      if (X(2, n) == X(2, nodes[s]) && (X.col(n) - X.col(nodes[s])).norm() < 0.035) {
        patch.push_back(n);
      }
    }
    for (const int n : patch) {
      entries.emplace_back(3 * n + 2, static_cast<int>(s),
                           force / static_cast<double>(patch.size()));
    }
  }
  Eigen::SparseMatrix<double> loads(X.size(), static_cast<Eigen::Index>(nodes.size()));
  loads.setFromTriplets(entries.begin(), entries.end());
  return loads;
}

}  // namespace palpable::test
