#include "palpable/bake/body_problem.h"

#include "palpable/bake/contact_sites.h"
#include "palpable/solid/equilibrium.h"
#include "tests/support/test.h"

#include <array>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using test::tolerance;

struct Block {
  SolidModel model;
  Boundary boundary;
  Site site;

  Block() {
    model.mesh = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, 4, 4, 4);
    model.material = material_from_young("neo-hookean", 60e3, 0.4);
    boundary = boundary_of(model.mesh);
    std::vector<std::uint8_t> fixed;
    for (const int n : boundary.node_of_vertex) {
      fixed.push_back(model.mesh.nodes(2, n) == 0.0);
      if (fixed.back() != 0) model.fixed_nodes.push_back(n);
    }
    site = choose_sites(boundary.surface, fixed, {.count = 1, .lowest = 0.08}).front();
  }
};

TEST_CASE("a traction on 4-node or 10-node elements carries the patch's newton along its direction",
          "[bake][problem]") {
  const Block block;
  const SolidModel fine = with_edge_nodes(block.model);
  for (const TetMesh& mesh : {block.model.mesh, fine.mesh}) {
    const Matrix3Xd force = unit_traction(block.site, block.boundary, mesh);
    CHECK((force.rowwise().sum() - block.site.direction).norm() <=
          tolerance(1e-6, "weights of single precision"));
  }
  CHECK((unit_load(block.site, block.boundary, fine.mesh.node_count()).rowwise().sum() -
         block.site.direction)
            .norm() <= tolerance(1e-6, "weights of single precision"));
}

TEST_CASE("10-node elements hold the edges of the held face and give way more", "[bake][problem]") {
  const Block block;
  const SolidModel fine = with_edge_nodes(block.model);
  CHECK(fine.fixed_nodes.size() == 9 * 9);  // of a face of 4 x 4 cells, with their diagonals
  for (const int n : fine.fixed_nodes) CHECK(fine.mesh.nodes(2, n) == 0.0);
  const auto press = [&](const SolidModel& model) {
    const Matrix3Xd unit = unit_traction(block.site, block.boundary, model.mesh);
    const PathResult path = EquilibriumSolver(model).solve_path(0.5 * unit, std::array{1.0});
    REQUIRE(path.complete);
    return unit.cwiseProduct(path.steps.back().displacement).sum();
  };
  const double coarse = press(block.model), better = press(fine);
  CHECK(better > 1.02 * coarse);
  CHECK(better < 2.0 * coarse);
}

}  // namespace
}  // namespace palpable
