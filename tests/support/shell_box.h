/// @file
/// A box of 20 x 30 x 40 mm as a shell for stress recovery.
#pragma once

#include "palpable/common/geometry/tet_mesh.h"
#include "palpable/common/material/material.h"
#include "palpable/common/response/shell_stress.h"

#include <cstddef>
#include <vector>

namespace palpable::test {

/// Its first `vertices` nodes are the skin's; stress at each is the mean over all points of the
/// elements that contain it.
/// @param materials  the first for the lower half, the last for the upper half
inline ShellTable shell_box(bool quadratic, int vertices, const std::vector<Material>& materials) {
  TetMesh mesh = box_tets({0, 0, 0}, {0.02, 0.03, 0.04}, 1, 2, 2);
  if (quadratic) mesh = with_edge_nodes(mesh);
  ShellTable shell;
  shell.stress_free = mesh.nodes;
  shell.preload.setZero(3, mesh.node_count());
  shell.element_nodes = quadratic ? 10 : 4;
  shell.materials = materials;
  std::vector<std::vector<int>> around(static_cast<std::size_t>(vertices));
  for (int e = 0; e < mesh.tet_count(); ++e) {
    double height = 0;
    for (const int n : mesh.tets.col(e)) {
      shell.elements.push_back(n);
      height += mesh.nodes(2, n) / 4;
      if (n < vertices) around[static_cast<std::size_t>(n)].push_back(e);
    }
    for (int k = 0; quadratic && k < 6; ++k) shell.elements.push_back(mesh.edge_nodes(k, e));
    shell.material_of.push_back(height < 0.02 ? 0 : static_cast<int>(materials.size()) - 1);
  }
  const int Q = shell.points_of_element();
  shell.first.push_back(0);
  for (const std::vector<int>& elements : around) {
    for (const int e : elements) {
      for (int q = 0; q < Q; ++q) {
        shell.points.push_back(Q * e + q);
        shell.weights.push_back(1.0f / static_cast<float>(Q * static_cast<int>(elements.size())));
      }
    }
    shell.first.push_back(static_cast<int>(shell.points.size()));
  }
  return shell;
}

}  // namespace palpable::test
