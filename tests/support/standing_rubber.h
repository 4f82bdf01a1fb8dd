/// @file
/// A body of rubber with any mesh that stands on its lowest nodes.
#pragma once

#include "palpable/bake/solid/solid_model.h"
#include "palpable/common/geometry/tet_mesh.h"

#include <utility>

namespace palpable::test {

/// Neo-Hookean, E = 60 kPa, nu = 0.4; the nodes at Z = 0 are held.
inline SolidModel standing_rubber(TetMesh mesh) {
  SolidModel model;
  model.mesh = std::move(mesh);
  model.material = material_from_young("neo-hookean", 60e3, 0.4);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) < 1e-6) model.fixed_nodes.push_back(n);
  }
  return model;
}

}  // namespace palpable::test
