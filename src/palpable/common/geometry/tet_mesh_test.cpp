#include "palpable/common/geometry/tet_mesh.h"

#include "palpable/common/base/contract.h"
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
    const int node = boundary.node_of_vertex[v];
    CHECK(boundary.surface.vertices.col(v) == mesh.nodes.col(node));
  }
}

TEST_CASE("a 10-node mesh has one node in the middle of each edge, shared by all around it",
          "[geometry][quadratic]") {
  const TetMesh mesh = brick(), fine = with_edge_nodes(mesh);
  CHECK_FALSE(mesh.is_quadratic());
  CHECK(fine.is_quadratic());
  CHECK(fine.tets == mesh.tets);
  CHECK(fine.nodes.leftCols(mesh.node_count()) == mesh.nodes);
  REQUIRE(fine.edge_nodes.cols() == mesh.tet_count());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const int a = mesh.tets(kTetEdges[k][0], e), b = mesh.tets(kTetEdges[k][1], e);
      CHECK(fine.nodes.col(fine.edge_nodes(k, e)) ==
            Vector3d(0.5 * (mesh.nodes.col(a) + mesh.nodes.col(b))));
    }
  }
  // The middles of the edges of Kuhn's cells, together with the corners, are all nodes of the grid
  // of half cells.
  CHECK(fine.node_count() == (2 * 2 + 1) * (2 * 3 + 1) * (2 * 4 + 1));
  CHECK(nodal_volumes(fine).minCoeff() > 0.0);
  CHECK(nodal_volumes(fine).sum() == Approx(6.0).margin(tolerance(1e-13, "sum of 1440")));
  CHECK(boundary_of(fine).surface.triangles == boundary_of(mesh).surface.triangles);
  CHECK_THROWS_AS(with_edge_nodes(fine), ContractViolation);
}

TEST_CASE("a 10-node mesh splits into 4-node tetrahedra on the same nodes, whatever its diagonals",
          "[geometry][quadratic]") {
  // Stretched along each axis in turn, so that each of the three diagonals is the shortest one.
  for (int axis = 0; axis < 3; ++axis) {
    INFO("axis " << axis);
    TetMesh coarse = brick();
    coarse.nodes.row(axis) *= 5.0;
    const TetMesh mesh = with_edge_nodes(coarse), fine = split_into_eight(mesh);
    CHECK_FALSE(fine.is_quadratic());
    CHECK(fine.nodes == mesh.nodes);
    REQUIRE(fine.tet_count() == 8 * mesh.tet_count());
    const Eigen::VectorXd volumes = tet_volumes(mesh), parts = tet_volumes(fine);
    for (int e = 0; e < mesh.tet_count(); ++e) {
      for (int k = 0; k < 8; ++k) {
        CHECK(parts[8 * e + k] ==
              Approx(volumes[e] / 8).epsilon(tolerance(1e-12, "rounding of corners near 5")));
      }
    }
    // The mesh is conforming: every inner face belongs to two tetrahedra.
    const SurfaceMesh skin = boundary_of(fine).surface;
    CHECK(skin.triangle_count() == 4 * boundary_of(mesh).surface.triangle_count());
    CHECK(check_watertight(skin).describe() == "watertight");
  }
  CHECK_THROWS_AS(split_into_eight(brick()), ContractViolation);
}

TEST_CASE("a box without cells or extent is refused", "[geometry][errors]") {
  CHECK_THROWS_AS(box_tets({0, 0, 0}, {1, 1, 1}, 1, 0, 1), ContractViolation);
  CHECK_THROWS_AS(box_tets({0, 0, 0}, {1, 0, 1}, 1, 1, 1), ContractViolation);
}

TEST_CASE("parts of a mesh that share no node are its components", "[geometry]") {
  const TetMesh one = box_tets({0, 0, 0}, {1, 1, 1}, 2, 1, 1);
  for (const bool quadratic : {false, true}) {
    INFO(quadratic);
    TetMesh two = one;
    const int N = one.node_count();
    // The second part comes first in the list of tetrahedra; between the nodes of the two parts is
    // one that belongs to no tetrahedron.
    two.nodes.resize(3, 2 * N + 1);
    two.nodes << one.nodes, Vector3d(9, 9, 9), one.nodes.colwise() + Vector3d(0, 0, 5);
    two.tets.resize(4, 2 * one.tet_count());
    two.tets << (one.tets.array() + N + 1).matrix(), one.tets;
    if (quadratic) two = with_edge_nodes(two);
    const std::vector<int> components = node_components(two);
    REQUIRE(static_cast<int>(components.size()) == two.node_count());
    for (int n = 0; n < two.node_count(); ++n) {
      CHECK(components[n] == (n == N ? -1 : two.nodes(2, n) > 4.0 ? 1 : 0));
    }
  }
}

}  // namespace
}  // namespace palpable
