#include "palpable/solid/solid_model.h"

#include "palpable/base/error.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using Catch::Matchers::Contains;

// A cube of 1 m, held at its lower face.
SolidModel cube() {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {1, 1, 1}, 2, 2, 2);
  model.material = material_from_young("neo-hookean", 1000, 0.3);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) == 0.0) model.fixed_nodes.push_back(n);
  }
  return model;
}

// Appends a tetrahedron that touches nothing else.
void add_island(SolidModel& model) {
  const int N = model.mesh.node_count(), E = model.mesh.tet_count();
  model.mesh.nodes.conservativeResize(3, N + 4);
  model.mesh.nodes.rightCols<4>() << 5, 6, 5, 5,  //
      0, 0, 1, 0,                                 //
      0, 0, 0, 1;
  model.mesh.tets.conservativeResize(4, E + 1);
  model.mesh.tets.col(E) << N, N + 1, N + 2, N + 3;
}

TEST_CASE("a sound model passes its check", "[solid][model]") {
  CHECK_NOTHROW(check_model(cube()));
}

TEST_CASE("an inverted element is named, and how many there are", "[solid][model][errors]") {
  SolidModel model = cube();
  std::swap(model.mesh.tets(1, 7), model.mesh.tets(2, 7));
  std::swap(model.mesh.tets(1, 9), model.mesh.tets(2, 9));
  CHECK_THROWS_WITH(check_model(model), Contains("2 inverted") && Contains("tetrahedron 7") &&
                                            Contains("volume -0.0208"));
}

TEST_CASE("an element without volume is refused", "[solid][model][errors]") {
  SolidModel model = cube();
  model.mesh.tets(3, 4) = model.mesh.tets(0, 4);
  CHECK_THROWS_WITH(check_model(model), Contains("1 flat") && Contains("tetrahedron 4"));
}

TEST_CASE("a body that is held nowhere is refused", "[solid][model][errors]") {
  SolidModel model = cube();
  model.fixed_nodes.clear();
  CHECK_THROWS_WITH(check_model(model), Contains("held nowhere") && Contains("three nodes"));
}

TEST_CASE("supports that let the body turn are refused", "[solid][model][errors]") {
  SolidModel model = cube();
  model.fixed_nodes = {0, 1};
  CHECK_THROWS_WITH(check_model(model), Contains("singular") && Contains("only 2"));
  model.fixed_nodes = {0, 1, 2};  // the box's first edge
  CHECK_THROWS_WITH(check_model(model), Contains("singular") && Contains("on one line"));
  model.fixed_nodes = {0, 1, 3};
  CHECK_NOTHROW(check_model(model));
}

TEST_CASE("a part of the body that is held by nothing is found", "[solid][model][errors]") {
  SolidModel model = cube();
  add_island(model);
  CHECK_THROWS_WITH(check_model(model),
                    Contains("a separate part of the body (4 nodes") && Contains("only 0"));
}

TEST_CASE("nodes that do not exist or are idle are refused", "[solid][model][errors]") {
  SolidModel model = cube();
  model.fixed_nodes.push_back(27);
  CHECK_THROWS_WITH(check_model(model), Contains("fixed node 27") && Contains("0 to 26"));
  model = cube();
  model.fixed_nodes.push_back(model.fixed_nodes.front());
  CHECK_THROWS_WITH(check_model(model), Contains("twice"));
  model = cube();
  model.mesh.nodes.conservativeResize(3, 28);
  model.mesh.nodes.col(27).setConstant(3);
  CHECK_THROWS_WITH(check_model(model), Contains("node 27") && Contains("no tetrahedron"));
  model = cube();
  model.mesh.tets(2, 3) = 99;
  CHECK_THROWS_WITH(check_model(model), Contains("tetrahedron 3 has node 99"));
  model = cube();
  model.fixed_displacement.setZero(3, 2);
  CHECK_THROWS_WITH(check_model(model), Contains("9 nodes are fixed but 2"));
  model = cube();
  model.mesh.tets.resize(4, 0);
  CHECK_THROWS_WITH(check_model(model), Contains("no tetrahedra"));
  model = cube();
  model.material = NeoHookean{.C1 = -1, .D1 = 1};
  CHECK_THROWS_WITH(check_model(model), Contains("mu"));
}

}  // namespace
}  // namespace palpable
