#include "palpable/bake/campaign/press_solver.h"

#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/selection.h"
#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <array>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

// A soft block that stands on its base, and a press on its lid.
struct Block {
  SolidModel model;
  Matrix3Xd unit;

  Block() {
    model.mesh = box_tets({0, 0, 0}, {0.1, 0.08, 0.12}, 3, 3, 4);
    model.material = material_from_young("neo-hookean", 20e3, 0.3);
    model.fixed_nodes = nodes_on_plane(model.mesh, {0, 0, 0}, {0, 0, 1}, 1e-9);
    const std::array nodes{nearest_node(model.mesh, {0.05, 0.04, 0.12})};
    unit = patch_force(model.mesh.node_count(), nodes, std::array{1.0}, {0.2, 0, -1});
  }
  [[nodiscard]] Matrix3Xd weight() const { return gravity_load(model.mesh, 1500, {0, 0, -9.81}); }
};

// Largest force that is out of balance at a free node, relative to the largest force.
double imbalance(const EquilibriumSolver& solver, const Matrix3Xd& u, const Matrix3Xd& load) {
  Matrix3Xd rest = solver.internal_force(u) - load;
  for (const HeldComponent& held : held_components(solver.model())) rest.reshaped()[held.at] = 0;
  return rest.cwiseAbs().maxCoeff() / load.cwiseAbs().maxCoeff();
}

TEST_CASE("without a preload a press is what the equilibrium solver makes of it",
          "[campaign][preload]") {
  const Block block;
  const EquilibriumSolver solver(block.model);
  const PressSolver presses(solver, Matrix3Xd(3, 0));
  CHECK_FALSE(presses.is_preloaded());
  CHECK(presses.rest().isZero(0.0));
  const LoadSearch a = presses.find_load(block.unit, 0.004),
                   b = solver.find_load(block.unit, 0.004);
  CHECK(a.load == b.load);
  CHECK(presses.solve_path(block.unit, std::array{0.5}).steps[0].displacement ==
        solver.solve_path(block.unit, std::array{0.5}).steps[0].displacement);
}

TEST_CASE("the weight acts in full at every level, and presses are counted from the shape it gives",
          "[campaign][preload]") {
  const Block block;
  const EquilibriumSolver solver(block.model);
  const Matrix3Xd weight = block.weight();
  const PressSolver presses(solver, weight);
  CHECK(presses.is_preloaded());
  CHECK(imbalance(solver, presses.rest(), weight) <=
        tolerance(1e-6, "the solver stops at 1e-8 of the norm of all forces"));
  CHECK(presses.rest().row(2).minCoeff() < -1e-3);  // it sags

  const LoadSearch search = presses.find_load(block.unit, 0.004);
  REQUIRE(search.reached);
  const double press = block.unit.cwiseProduct(search.state.displacement - presses.rest()).sum();
  CHECK(press == Approx(0.004).epsilon(tolerance(1e-5, "where the search stops")));
  CHECK(search.press == press);

  const PathResult path = presses.solve_path(search.load * block.unit, std::array{0.3, 1.0});
  REQUIRE(path.complete);
  for (const Equilibrium& step : path.steps) {
    INFO("level " << step.level);
    CHECK(imbalance(solver, step.displacement, weight + step.level * search.load * block.unit) <=
          tolerance(1e-6, "the solver stops at 1e-8 of the norm of all forces"));
  }
  CHECK((path.steps[1].displacement - search.state.displacement).cwiseAbs().maxCoeff() <=
        tolerance(1e-8, "two ways to one state of some millimetres"));
  // The sagging body is another body: its load differs from the unloaded one's.
  CHECK(std::abs(search.load / solver.find_load(block.unit, 0.004).load - 1.0) > 1e-3);
}

TEST_CASE("a base that is moved takes the body along before it is pressed", "[campaign][preload]") {
  const Block block;
  const Vector3d step(0.002, -0.001, 0.003);
  SolidModel moved = block.model;
  moved.supports.clear();
  for (const int n : moved.fixed_nodes) moved.supports.push_back({n, {true, true, true}, step});
  moved.fixed_nodes.clear();
  const EquilibriumSolver solver(block.model), of_moved(moved);
  const PressSolver here(solver, block.weight()), there(of_moved, block.weight());
  CHECK(((there.rest() - here.rest()).colwise() - step).cwiseAbs().maxCoeff() <=
        tolerance(1e-8, "a rigid motion of 4 mm, solved to 1e-8 of the forces"));
  const LoadSearch a = here.find_load(block.unit, 0.004), b = there.find_load(block.unit, 0.004);
  REQUIRE((a.reached && b.reached));
  CHECK(b.load ==
        Approx(a.load).epsilon(tolerance(1e-4, "two searches, each to 1e-5 of the press")));
  // A motion of supports that bends the body is a preload even without other loads.
  for (Support& support : moved.supports) {
    support.displacement = Vector3d(0, 0, 0.05 * moved.mesh.nodes(0, support.node));
  }
  const EquilibriumSolver of_tilted(moved);
  const PressSolver tilted(of_tilted, Matrix3Xd(3, 0));
  CHECK(tilted.is_preloaded());
  CHECK(tilted.rest().cwiseAbs().maxCoeff() > 0.004);
  CHECK(tilted.find_load(block.unit, 0.004).reached);
}

TEST_CASE("a press may have a range of its own, a preload has that of the model",
          "[campaign][preload][range]") {
  Block block;
  block.model.largest_displacement = 0.006;
  const EquilibriumSolver solver(block.model);
  const Matrix3Xd weight = 0.3 * block.weight();  // 2 mm of sag
  const PressSolver narrow(solver, weight), wide(solver, weight, 0.03);
  CHECK(narrow.range() == 0.006);
  CHECK(wide.range() == 0.03);
  const LoadSearch short_of_it = narrow.find_load(block.unit, 0.009);
  CHECK_FALSE(short_of_it.reached);
  CHECK(short_of_it.stop == Stop::kBeyondRange);
  CHECK(wide.find_load(block.unit, 0.009).reached);
  CHECK_THROWS_WITH(PressSolver(solver, 20 * block.weight(), 0.03), Contains("by more than 6 mm"));
}

TEST_CASE("a preload that crushes the body is refused, a press too far stops at the last good load",
          "[campaign][preload]") {
  const Block block;
  const EquilibriumSolver solver(block.model);
  CHECK_THROWS_WITH(PressSolver(solver, 1e3 * block.weight()),
                    Contains("cannot bear what acts on it before it is pressed") &&
                        !Contains("press less"));  // nothing is pressed yet
  SolidModel soft = block.model;
  soft.material = material_from_young("saint-venant-kirchhoff", 20e3, 0.3);
  const EquilibriumSolver collapsing(soft);
  const LoadSearch search = PressSolver(collapsing, block.weight()).find_load(block.unit, 0.09);
  CHECK_FALSE(search.reached);
  CHECK(search.load > 0.0);
  CHECK(search.press < 0.09);
  CHECK_THAT(search.why_stopped, Contains("a press of 90 mm was not reached"));
}

}  // namespace
}  // namespace palpable
