#include "palpable/geometry/tet_mesh.h"

#include "palpable/base/contract.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

TetMesh brick() { return box_tets({0, 0, 0}, {1, 2, 3}, 2, 3, 4); }

TEST_CASE("a box of tetrahedra has positive volumes that sum to the box", "[geometry]") {
  const Eigen::VectorXd volumes = tet_volumes(brick());
  REQUIRE(volumes.size() == 2 * 3 * 4 * 6);
  CHECK(volumes.minCoeff() > 0.0);
  const double rounding = tolerance(1e-13, "sum of 144 volumes of 0.04");
  CHECK(volumes.sum() == Approx(6.0).margin(rounding));
  CHECK(nodal_volumes(brick()).sum() == Approx(6.0).margin(rounding));
}

TEST_CASE("the skin of a volume is watertight, faces outwards and encloses it", "[geometry]") {
  const TetMesh mesh = brick();
  const Boundary boundary = boundary_of(mesh);
  CHECK(check_watertight(boundary.surface).describe() == "watertight");
  CHECK(enclosed_volume(boundary.surface) == Approx(6.0).margin(tolerance(1e-13, "sum of 104")));
  CHECK(boundary.surface.triangle_count() == 2 * 2 * (2 * 3 + 3 * 4 + 4 * 2));
  CHECK(boundary.surface.vertex_count() == mesh.node_count() - 1 * 2 * 3);  // inner nodes left out
  for (int v = 0; v < boundary.surface.vertex_count(); ++v) {
    const int node = boundary.node_of_vertex[static_cast<std::size_t>(v)];
    CHECK(boundary.surface.vertices.col(v) == mesh.nodes.col(node));
  }
}

TEST_CASE("a box without cells or extent is refused", "[geometry][errors]") {
  CHECK_THROWS_AS(box_tets({0, 0, 0}, {1, 1, 1}, 1, 0, 1), ContractViolation);
  CHECK_THROWS_AS(box_tets({0, 0, 0}, {1, 0, 1}, 1, 1, 1), ContractViolation);
}

}  // namespace
}  // namespace palpable
