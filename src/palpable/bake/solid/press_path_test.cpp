#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/lockstep.h"
#include "palpable/bake/solid/selection.h"
#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <array>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

// A soft block that stands on its base, and unit loads on its top and sides.
struct Block {
  SolidModel model;
  std::vector<Matrix3Xd> presses;

  explicit Block(const char* law = "neo-hookean") {
    model.mesh = box_tets({0, 0, 0}, {0.1, 0.08, 0.12}, 4, 3, 5);
    model.material = material_from_young(law, 20e3, 0.3);
    model.fixed_nodes = nodes_on_plane(model.mesh, {0, 0, 0}, {0, 0, 1}, 1e-9);
    for (const Vector3d& X : {Vector3d(0.05, 0.04, 0.12), Vector3d(0.1, 0.08, 0.12),
                              Vector3d(0, 0.03, 0.1), Vector3d(0.1, 0.0, 0.06)}) {
      const std::array nodes{nearest_node(model.mesh, X)};
      presses.push_back(patch_force(model.mesh.node_count(), nodes, std::array{1.0},
                                    Vector3d(0.05, 0.04, 0.05) - X));
    }
  }
  [[nodiscard]] int node_count() const { return model.mesh.node_count(); }
};

double press_of(const Matrix3Xd& unit, const Matrix3Xd& u) { return unit.cwiseProduct(u).sum(); }

TEST_CASE("a press path is the load search and the path to that load", "[solid][press]") {
  const Block block;
  const EquilibriumSolver solver(block.model);
  for (const Matrix3Xd& unit : block.presses) {
    const PressPath path = solver.press_path(unit, {.press = 0.006, .levels = 5});
    REQUIRE(path.reached);
    CHECK(path.why_stopped.empty());
    const LoadSearch search = solver.find_load(unit, 0.006);
    CHECK(path.full_load ==
          Approx(search.load).epsilon(tolerance(1e-4, "a search that ends at 1e-5 of the press")));
    const PathResult plain =
        solver.solve_path(path.full_load * unit, std::array{0.2, 0.4, 0.6, 0.8, 1.0});
    REQUIRE(path.steps.size() == 5);
    REQUIRE(path.press.size() == 6);
    CHECK(path.press[0] == 0.0);
    CHECK(path.press[5] == Approx(0.006).epsilon(tolerance(1e-5, "where the search ends")));
    for (std::size_t l = 0; l < 5; ++l) {
      const Matrix3Xd& u = path.steps[l].displacement;
      CHECK(path.steps[l].level == plain.steps[l].level);
      CHECK(path.press[Eigen::Index(l) + 1] == press_of(unit, u));
      CHECK((u - plain.steps[l].displacement).cwiseAbs().maxCoeff() <=
            tolerance(1e-6, "both are solved to 1e-8 of the force; of a press of 6 mm") * 0.006);
    }
  }
}

TEST_CASE("a force that is asked for is the full load", "[solid][press]") {
  const Block block;
  const EquilibriumSolver solver(block.model);
  const PressPath path = solver.press_path(block.presses[0], {.force = 0.3, .levels = 3});
  REQUIRE(path.reached);
  CHECK(path.full_load == 0.3);
  CHECK((path.steps[2].displacement -
         solver.solve_path(0.3 * block.presses[0], std::array{1.0}).steps[0].displacement)
            .cwiseAbs()
            .maxCoeff() <= tolerance(1e-8, "two ways to one state of some millimetres"));
}

TEST_CASE("a path in lockstep that takes long gets a factor of its own",
          "[solid][press][lockstep]") {
  const Block block;
  const auto solve = [&](int iterations) {
    const EquilibriumSolver solver(block.model, {.iterations_in_lockstep = iterations});
    PressPath path;
    std::optional<int> next = 0;
    run_in_lockstep([&] { return std::exchange(next, std::nullopt); },
                    [&](int, Lane& lane) {
                      path = solver.press_path(block.presses[0], {.press = 0.01, .levels = 4},
                                               {.lane = &lane});
                    },
                    {.threads = 1, .lanes = 1});
    return path;
  };
  const PressPath shared = solve(600), own = solve(10);
  REQUIRE(shared.reached);
  REQUIRE(own.reached);
  CHECK(shared.factors == 0);
  // More than one would mean that every step makes its own.
  CHECK(own.factors == 1);
  CHECK(own.cg_iterations < shared.cg_iterations);
  CHECK((own.steps[3].displacement - shared.steps[3].displacement).cwiseAbs().maxCoeff() <=
        tolerance(1e-5, "searches that end at 1e-5 of the press") * 0.01);
}

TEST_CASE("paths in lockstep are the same to the bit in any company, and plain ones to tolerance",
          "[solid][press][lockstep][threads]") {
  const Block block;
  const EquilibriumSolver solver(block.model);
  const PressGoal goal{.press = 0.01, .levels = 4};
  const auto solve = [&](const LockstepSettings& settings) {
    std::vector<PressPath> paths(block.presses.size());
    int next = 0;
    run_in_lockstep(
        [&]() -> std::optional<int> {
          return next < static_cast<int>(paths.size()) ? std::optional(next++) : std::nullopt;
        },
        [&](int s, Lane& lane) {
          paths[std::size_t(s)] =
              solver.press_path(block.presses[std::size_t(s)], goal, {.lane = &lane});
        },
        settings);
    return paths;
  };
  const std::vector<PressPath> alone = solve({.threads = 1, .lanes = 1});
  for (const LockstepSettings& settings :
       {LockstepSettings{.threads = 1, .lanes = 4}, LockstepSettings{.threads = 3, .lanes = 3}}) {
    const std::vector<PressPath> together = solve(settings);
    for (std::size_t s = 0; s < alone.size(); ++s) {
      INFO("press " << s);
      CHECK(together[s].full_load == alone[s].full_load);
      REQUIRE(together[s].steps.size() == alone[s].steps.size());
      for (std::size_t l = 0; l < alone[s].steps.size(); ++l) {
        CHECK(together[s].steps[l].displacement == alone[s].steps[l].displacement);
      }
    }
  }
  for (std::size_t s = 0; s < alone.size(); ++s) {
    const PressPath plain = solver.press_path(block.presses[s], goal);
    REQUIRE(plain.steps.size() == alone[s].steps.size());
    CHECK((plain.steps.back().displacement - alone[s].steps.back().displacement)
              .cwiseAbs()
              .maxCoeff() <=
          tolerance(1e-4, "loads found to 1e-5 of the press each; times its 10 mm") * 0.01);
  }
}

TEST_CASE("a press that the body does not bear ends a little before, and disturbs no other lane",
          "[solid][press][lockstep]") {
  const Block block("saint-venant-kirchhoff");
  const EquilibriumSolver solver(block.model);
  const std::array<PressGoal, 4> goals{
      PressGoal{.press = 0.003, .levels = 3}, PressGoal{.press = 0.11, .levels = 3},
      PressGoal{.press = 0.003, .levels = 3}, PressGoal{.force = 1e4, .levels = 3}};
  std::array<PressPath, 4> paths;
  int next = 0;
  run_in_lockstep(
      [&]() -> std::optional<int> { return next < 4 ? std::optional(next++) : std::nullopt; },
      [&](int s, Lane& lane) {
        const auto at = std::size_t(s);
        paths[at] = solver.press_path(block.presses[at], goals[at], {.lane = &lane});
      },
      {.threads = 1, .lanes = 4});
  CHECK(paths[0].reached);
  CHECK(paths[2].reached);
  for (const std::size_t s : {1U, 3U}) {
    INFO("press " << s);
    CHECK_FALSE(paths[s].reached);
    CHECK(paths[s].stop != Stop::kNone);
    CHECK_FALSE(paths[s].why_stopped.empty());
    REQUIRE(paths[s].steps.size() == 3);
    CHECK(paths[s].full_load > 0.0);
    for (Eigen::Index l = 1; l < 4; ++l) CHECK(paths[s].press[l] > paths[s].press[l - 1]);
    // The states that are kept are in equilibrium.
    Matrix3Xd off = solver.internal_force(paths[s].steps[2].displacement) -
                    paths[s].full_load * block.presses[s];
    for (const int n : block.model.fixed_nodes) off.col(n).setZero();
    CHECK(off.norm() <=
          tolerance(1e-6, "1e-8 of all forces, the reactions too") * paths[s].full_load);
  }
  CHECK(paths[1].press[3] < 0.11);
  CHECK_THAT(paths[1].why_stopped, Contains("a press of 110 mm was not reached"));
}

TEST_CASE("on a preload levels are counted from its state", "[solid][press][preload]") {
  const Block block;
  const EquilibriumSolver solver(block.model);
  Preloaded weight;
  weight.force = gravity_load(block.model.mesh, 1500, {0, 0, -9.81});
  weight.rest = solver.solve_path(weight.force, std::array{1.0}).steps[0].displacement;
  const Matrix3Xd& unit = block.presses[1];
  const PathOptions on_top{.preloaded = &weight};
  const PressPath path = solver.press_path(unit, {.press = 0.006, .levels = 4}, on_top);
  REQUIRE(path.reached);
  for (std::size_t l = 0; l < 4; ++l) {
    const Equilibrium& step = path.steps[l];
    CHECK(path.press[Eigen::Index(l) + 1] ==
          Approx(press_of(unit, step.displacement - weight.rest)).epsilon(1e-12));
    Matrix3Xd off = solver.internal_force(step.displacement) - weight.force -
                    step.level * path.full_load * unit;
    for (const int n : block.model.fixed_nodes) off.col(n).setZero();
    CHECK(off.norm() <=
          tolerance(1e-6, "1e-8 of all forces, the reactions too") * weight.force.norm());
  }
  // The search starts from the preloaded state, so the path costs hardly more than one without
  // preload.
  const PressPath plain = solver.press_path(unit, {.press = 0.006, .levels = 4});
  CHECK(path.newton_steps <= 2 * plain.newton_steps);
  // The preload has an effect: the loads differ by 5e-4, the tolerance of the search is 1e-5.
  CHECK(path.full_load != Approx(plain.full_load).epsilon(1e-4));
}

TEST_CASE("a press path refuses what a load search refuses", "[solid][press]") {
  const Block block;
  SolidModel moved = block.model;
  moved.fixed_displacement =
      Vector3d(0, 0, 0.001).replicate(1, Eigen::Index(moved.fixed_nodes.size()));
  CHECK_THROWS_WITH(
      EquilibriumSolver(moved).press_path(block.presses[0], {.press = 0.01, .levels = 2}),
      Contains("while supports move"));
  CHECK_THROWS_WITH(EquilibriumSolver(block.model)
                        .press_path(Matrix3Xd::Zero(3, block.node_count()), {.press = 0.01}),
                    Contains("the load is zero"));
}

}  // namespace
}  // namespace palpable
