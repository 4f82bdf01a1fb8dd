#include "palpable/bake/mesh/turned_tets.h"

#include "tests/support/test.h"

#include <cmath>
#include <utility>

namespace palpable {
namespace {

// newton#2408: half of a file's tetrahedra with the nodes 2 and 3 swapped.
TEST_CASE("tetrahedra wound the other way are turned, with the middles of their edges",
          "[mesh][repair]") {
  const TetMesh box = with_edge_nodes(box_tets({0, 0, 0}, {1, 2, 3}, 2, 2, 1));
  TetMesh mesh = box;
  int swapped = 0;
  for (Eigen::Index e = 0; e < mesh.tets.cols(); e += 2, ++swapped) {
    std::swap(mesh.tets(2, e), mesh.tets(3, e));
    std::swap(mesh.edge_nodes(1, e), mesh.edge_nodes(4, e));
    std::swap(mesh.edge_nodes(2, e), mesh.edge_nodes(3, e));
  }
  CHECK(turn_inverted(mesh) == swapped);
  CHECK(mesh.tets == box.tets);
  CHECK(mesh.edge_nodes == box.edge_nodes);
  // Each middle lies between the ends of its edge.
  for (Eigen::Index e = 0; e < mesh.tets.cols(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector3d middle = 0.5 * (mesh.nodes.col(mesh.tets(kTetEdges[k][0], e)) +
                                            mesh.nodes.col(mesh.tets(kTetEdges[k][1], e)));
      CHECK(mesh.nodes.col(mesh.edge_nodes(k, e)) == middle);
    }
  }
  CHECK(turn_inverted(mesh) == 0);
  TetMesh all = box_tets({0, 0, 0}, {1, 1, 1}, 1, 1, 1);
  all.tets.row(0).swap(all.tets.row(1));
  CHECK(turn_inverted(all) == 6);
  CHECK(tet_volumes(all).minCoeff() > 0.0);
  CHECK(std::abs(tet_volumes(all).sum() - 1.0) < 1e-14);
}

TEST_CASE("a tetrahedron that is folded over its neighbours is not turned", "[mesh][repair]") {
  TetMesh mesh = box_tets({0, 0, 0}, {1, 1, 1}, 2, 2, 2);
  mesh.nodes.col(13) << 1.4, 0.5, 0.5;  // the middle node, pushed out of the box
  const TetMesh given = mesh;
  REQUIRE(tet_volumes(mesh).minCoeff() < 0.0);
  CHECK(turn_inverted(mesh) == 0);
  CHECK(mesh.tets == given.tets);
  TetMesh flat = box_tets({0, 0, 0}, {1, 1, 1}, 1, 1, 1);
  flat.tets.row(0).swap(flat.tets.row(1));
  flat.tets(3, 2) = flat.tets(2, 2);
  CHECK(turn_inverted(flat) == 0);
}

}  // namespace
}  // namespace palpable
