#include "palpable/bake/solid/solid_model.h"

#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <cmath>

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

// Holds every node of the plane X_axis = 0 along its normal.
void add_symmetry(SolidModel& model, int axis) {
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(axis, n) != 0.0) continue;
    Support support{.node = n, .held = {false, false, false}};
    support.held[axis] = true;
    model.supports.push_back(support);
  }
}

TEST_CASE("three symmetry planes hold a body, two do not", "[solid][model][supports]") {
  SolidModel model = cube();
  model.fixed_nodes.clear();
  add_symmetry(model, 0);
  CHECK_THROWS_WITH(check_model(model), Contains("3 of its 6 rigid motions"));
  add_symmetry(model, 1);
  CHECK_THROWS_WITH(check_model(model), Contains("18 held directions leave 1 of its 6"));
  add_symmetry(model, 2);
  CHECK_NOTHROW(check_model(model));
  // The planes share nodes on the edges; each component counts once.
  CHECK(held_components(model).size() == 27);
}

TEST_CASE("six directions at three nodes are enough, if they are the right ones",
          "[solid][model][supports]") {
  SolidModel model = cube();
  model.fixed_nodes = {0};
  // Node 2 lies on the x axis, node 6 on the y axis.
  model.supports = {{.node = 2, .held = {false, true, true}},
                    {.node = 6, .held = {false, false, true}}};
  CHECK_NOTHROW(check_model(model));
  model.supports[1].held = {true, false, false};  // does not stop a turn about x
  CHECK_THROWS_WITH(check_model(model), Contains("1 of its 6"));
}

TEST_CASE("what is held is listed once, with fixed nodes and supports together",
          "[solid][model][supports]") {
  SolidModel model = cube();
  model.fixed_nodes = {3, 1};
  model.fixed_displacement.resize(3, 2);
  model.fixed_displacement << 30, 10, 31, 11, 32, 12;
  model.supports = {{.node = 1, .held = {true, false, false}, .displacement = {10, 0, 0}},
                    {.node = 2, .held = {false, true, false}, .displacement = {99, 7, 99}}};
  const std::vector<HeldComponent> held = held_components(model);
  REQUIRE(held.size() == 7);
  const int at[] = {3, 4, 5, 7, 9, 10, 11};
  const double u[] = {10, 11, 12, 7, 30, 31, 32};
  for (std::size_t k = 0; k < 7; ++k) {
    CHECK(held[k].at == at[k]);
    CHECK(held[k].displacement == u[k]);
  }
}

TEST_CASE("supports that contradict each other or hold nothing are refused",
          "[solid][model][supports][errors]") {
  SolidModel model = cube();
  model.supports = {{.node = 0, .held = {true, false, false}, .displacement = {0.1, 0, 0}}};
  CHECK_THROWS_WITH(check_model(model), Contains("node 0 is held in x at two displacements"));
  model.supports = {{.node = 99, .held = {true, false, false}}};
  CHECK_THROWS_WITH(check_model(model), Contains("node 99") && Contains("0 to 26"));
  model.supports = {{.node = 20, .held = {false, false, false}}};
  CHECK_THROWS_WITH(check_model(model), Contains("in no direction"));
  model.supports = {
      {.node = 20, .held = {false, true, false}, .displacement = {0, std::nan(""), 0}}};
  CHECK_THROWS_WITH(check_model(model), Contains("node 20 is not finite"));
}

}  // namespace
}  // namespace palpable
