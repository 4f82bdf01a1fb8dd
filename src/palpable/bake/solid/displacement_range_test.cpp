#include "palpable/bake/solid/displacement_range.h"

#include "palpable/bake/solid/contact.h"
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/joined_model.h"
#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/selection.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

// A soft block of 30 x 30 x 60 mm that stands on its base, and a press from the side at its top.
struct Post {
  SolidModel model;
  Matrix3Xd unit;

  explicit Post(const char* law = "neo-hookean", double range = 0.02) {
    model.mesh = box_tets({0, 0, 0}, {0.03, 0.03, 0.06}, 3, 3, 6);
    model.material = material_from_young(law, 20e3, 0.3);
    model.fixed_nodes = nodes_on_plane(model.mesh, {0, 0, 0}, {0, 0, 1}, 1e-9);
    model.largest_displacement = range;
    const std::array nodes{nearest_node(model.mesh, {0.03, 0.02, 0.05})};
    unit = patch_force(model.mesh.node_count(), nodes, std::array{1.0}, {-1, 0, 0});
  }
  [[nodiscard]] double moved(const Matrix3Xd& u) const {
    return largest_movement(held_components(model), u);
  }
};

TEST_CASE("what all supports move alike is not a movement of the body", "[solid][range]") {
  Post post;
  SolidModel& model = post.model;
  const int N = model.mesh.node_count();
  const Vector3d step(0.4, -0.5, 0.7);
  Matrix3Xd u = step.replicate(1, N);
  u.col(N - 1) += Vector3d(0.001, -0.002, 0.002);
  // Of held nodes that stay, the displacement is all movement.
  Matrix3Xd stays = u;
  for (const int n : model.fixed_nodes) stays.col(n).setZero();
  CHECK(post.moved(stays) == Approx((step + Vector3d(0.001, -0.002, 0.002)).norm()));
  for (const int n : model.fixed_nodes) model.supports.push_back({n, {true, true, true}, step});
  model.fixed_nodes.clear();
  CHECK(post.moved(u) == Approx(0.003).epsilon(tolerance(1e-9, "rounding beside a step of 1 m")));
  // Half the way, as a path with growing supports passes it.
  CHECK(post.moved(0.5 * u) == Approx(0.0015).epsilon(1e-9));
  // Held in z alone: a common step in z is left out, those in x and y are movements.
  for (Support& support : model.supports) support.held = {false, false, true};
  CHECK(post.moved(u) == Approx((Vector3d(0.4, -0.5, 0) + Vector3d(0.001, -0.002, 0.002)).norm()));
  // Grips that part: nothing is common.
  for (Support& support : model.supports) {
    if (support.node % 2 == 0) support.displacement[2] = -0.7;
  }
  CHECK(post.moved(u) == Approx((step + Vector3d(0.001, -0.002, 0.002)).norm()));
}

TEST_CASE("a path ends just before a node moves beyond the range of the model", "[solid][range]") {
  const Post post;
  const EquilibriumSolver solver(post.model);
  const PathResult path = solver.solve_path(50.0 * post.unit, std::array{0.001, 0.5, 1.0});
  CHECK_FALSE(path.complete);
  CHECK(path.stop == Stop::kBeyondRange);
  REQUIRE(path.steps.size() == 1);
  CHECK_THAT(path.why_stopped, Contains("load level 0.5 was not reached") &&
                                   Contains("by more than 20 mm") &&
                                   Contains("'range' in [press]") && Contains("units"));
  // The same load is solved without the limit, or below it.
  SolidModel free = post.model;
  free.largest_displacement = std::numeric_limits<double>::infinity();
  CHECK(EquilibriumSolver(free).solve_path(0.1 * post.unit, std::array{1.0}).complete);
  CHECK(solver.solve_path(0.1 * post.unit, std::array{1.0}).complete);
}

TEST_CASE("a force and a depth that leave the range stop at the same load", "[solid][range]") {
  const Post post;
  const EquilibriumSolver solver(post.model);
  const PressPath by_force = solver.press_path(post.unit, {.force = 30.0, .levels = 4});
  const PressPath by_depth = solver.press_path(post.unit, {.press = 0.03, .levels = 4});
  for (const PressPath* path : {&by_force, &by_depth}) {
    CHECK_FALSE(path->reached);
    CHECK_THAT(path->why_stopped, Contains("by more than 20 mm"));
    REQUIRE(path->steps.size() == 4);
    const double moved = post.moved(path->steps.back().displacement);
    CHECK(moved <= 0.02);
    CHECK(moved > 0.012);  // 95 % of the last good load, see below
  }
  // Increments are halved six times: the last good load is less than 1/64 of a level below the end.
  const double increment = 30.0 / 4 / 64;
  CHECK(by_force.full_load <= by_depth.full_load);
  CHECK(by_force.full_load > by_depth.full_load - increment);
  // Within the range nothing changes.
  const PressPath within = solver.press_path(post.unit, {.press = 0.01, .levels = 4});
  CHECK(within.reached);
  SolidModel free = post.model;
  free.largest_displacement = std::numeric_limits<double>::infinity();
  CHECK(EquilibriumSolver(free).press_path(post.unit, {.press = 0.01, .levels = 4}).full_load ==
        within.full_load);
}

TEST_CASE("any excess of a force finds a load that the model bears", "[solid][range]") {
  const Post post;
  const EquilibriumSolver solver(post.model);
  for (const double force : {5.0, 500.0, 1e6}) {
    const PressPath path = solver.press_path(post.unit, {.force = force, .levels = 3});
    INFO("force " << force << ": " << path.why_stopped);
    CHECK_FALSE(path.reached);
    REQUIRE(path.steps.size() == 3);
    CHECK(path.full_load > 0.0);
    CHECK(post.moved(path.steps.back().displacement) <= 0.02);
  }
}

TEST_CASE("an obstacle cannot push a body out of its range", "[solid][range][contact]") {
  const Post post;
  const EquilibriumSolver solver(post.model);
  const auto way = [](double t) {
    const Vector3d at(0.045 - 0.06 * t, 0.015, 0.05);
    return Obstacle{
        .capsules = {{at - Vector3d(0, 0.03, 0), at + Vector3d(0, 0.03, 0), 0.01, 0.01}}};
  };
  ContactWalk walk(solver, way, 0.0);
  bool arrived = true;
  for (int step = 1; step <= 20 && arrived; ++step) arrived = walk.advance(0.05 * step);
  CHECK_FALSE(arrived);
  CHECK(walk.stop() == Stop::kBeyondRange);
  CHECK_THAT(walk.why_stopped(), Contains("by more than 20 mm"));
  CHECK(post.moved(walk.now().displacement) <= 0.02);
  CHECK(post.moved(walk.now().displacement) > 0.018);
}

TEST_CASE("a joined model has the range of its largest body", "[solid][range]") {
  const std::array bodies{Post("neo-hookean", 0.02).model, Post("neo-hookean", 0.05).model};
  Rigid3 there = Rigid3::Identity();
  there.translation() = Vector3d(0.2, 0, 0);
  CHECK(joined(bodies, std::array{Rigid3(Rigid3::Identity()), there}).model.largest_displacement ==
        0.05);
}

TEST_CASE("an element's largest expansion is found among those that shrink", "[solid][range]") {
  const Post post;
  Matrix3Xd u = -0.1 * post.model.mesh.nodes;
  CHECK(largest_volume_ratio(post.model.mesh, u) == Approx(std::pow(0.9, 3)));
  u.row(2) = 0.5 * post.model.mesh.nodes.row(2);
  CHECK(largest_volume_ratio(post.model.mesh, u) == Approx(0.9 * 0.9 * 1.5));
}

TEST_CASE("a law that is not there is not advised, and one that softens when it expands says J",
          "[solid][range]") {
  const Post block;
  Matrix3Xd u = Matrix3Xd::Zero(3, block.model.mesh.node_count());
  CHECK_FALSE(expansion_text(block.model.mesh, u));
  u.row(2) = 0.4 * block.model.mesh.nodes.row(2);
  CHECK_FALSE(expansion_text(block.model.mesh, u));
  u.row(2) = 1.6 * block.model.mesh.nodes.row(2);
  const auto text = expansion_text(block.model.mesh, u);
  REQUIRE(text);
  CHECK_THAT(*text, Contains("expanded to J = 2.6 ") && Contains("pull less"));
  CHECK_THAT(*text, !Contains("neo-hookean"));

  // The law is not advised to a body of that law that is pressed too far.
  const Post post("neo-hookean", std::numeric_limits<double>::infinity());
  CHECK_THAT(EquilibriumSolver(post.model).find_load(post.unit, 0.2).why_stopped,
             !Contains("neo-hookean"));
}

}  // namespace
}  // namespace palpable
