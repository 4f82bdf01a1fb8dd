/// @file
/// A block of rubber that stands on the ground, for tests that press sites.
#pragma once

#include "palpable/bake/describe/contact_sites.h"
#include "palpable/bake/solid/solid_model.h"
#include "palpable/common/geometry/tet_mesh.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace palpable::test {

/// 60 x 40 x 50 mm, held where Z < 1 mm; `site_count` sites above 20 mm with patches of one edge.
struct RubberBlock {
  TetMesh mesh = box_tets({-0.03, -0.02, 0}, {0.03, 0.02, 0.05}, 4, 3, 4);
  Boundary boundary = boundary_of(mesh);
  std::vector<Site> sites;

  explicit RubberBlock(int site_count) {
    std::vector<std::uint8_t> fixed;
    for (const auto& x : boundary.surface.vertices.colwise()) fixed.push_back(x[2] < 0.001);
    sites = choose_sites(boundary.surface, fixed,
                         {.count = site_count, .lowest = 0.02, .patch_distance = 1});
  }

  /// E = 60 kPa, nu = 0.4. @param law  one of law_names()
  [[nodiscard]] SolidModel model(std::string_view law) const {
    SolidModel model{.mesh = mesh,
                     .material = material_from_young(law, 60e3, 0.4),
                     .fixed_nodes = {},
                     .fixed_displacement = {}};
    for (int n = 0; n < mesh.node_count(); ++n) {
      if (mesh.nodes(2, n) < 0.001) model.fixed_nodes.push_back(n);
    }
    return model;
  }
};

}  // namespace palpable::test
