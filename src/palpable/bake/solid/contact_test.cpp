// Contact with rigid obstacles: the flat punch, Hertz, energy, independence of the path.
#include "palpable/bake/solid/contact.h"

#include "palpable/bake/solid/hertz_block.h"
#include "palpable/bake/solid/selection.h"
#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <memory>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

// A cube of 0.1 m and 20 kPa, held at its base.
SolidModel block(int cells) {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, cells, cells, cells);
  model.material = material_from_young("neo-hookean", 20e3, 0.3);
  model.fixed_nodes = nodes_on_plane(model.mesh, {0, 0, 0}, {0, 0, 1}, 1e-9);
  return model;
}

// A ball that touches the block's top at t = 0 and is t (m) deep later.
Obstacle ball_at(double t) { return {.capsules = {ball({0.051, 0.048, 0.12 - t}, 0.02)}}; }

void check_conditions(const ContactWalk& walk) {
  const ContactState& state = walk.now();
  CHECK(state.smallest_gap >= -1e-6 * walk.body_size());
  CHECK(state.smallest_force >= 0.0);
  CHECK(state.complementarity <= 1e-6);
  CHECK(state.residual <= 1e-7);
  CHECK((walk.nodal_forces().rowwise().sum() - state.force).norm() <=
        1e-12 * (1.0 + state.force.norm()));
}

TEST_CASE("a lid presses a block that may slide into a uniform field", "[solid][contact]") {
  SolidModel model = block(4);
  model.fixed_nodes.clear();
  for (int axis = 0; axis < 3; ++axis) {
    Support slides{.node = 0, .held = {axis == 0, axis == 1, axis == 2}};
    for (const int node : nodes_on_plane(model.mesh, {0, 0, 0}, Vector3d::Unit(axis), 1e-9)) {
      slides.node = node;
      model.supports.push_back(slides);
    }
  }
  const EquilibriumSolver solver(model);
  const auto lid = [](double t) {
    return Obstacle{.half_spaces = {{{0, 0, 0.1 - t}, {0, 0, -1}}}};
  };
  // Whether 1e-11 is reached depends on how the matrix products of the processor round.
  ContactWalk walk(solver, lid, -0.001, {.tolerance = 1e-10, .largest_entry = 1e-10});
  const bool reached = walk.advance(0.02);
  INFO(walk.why_stopped());
  REQUIRE(reached);
  check_conditions(walk);
  const Matrix3Xd& u = walk.now().displacement;
  const Vector3d stretch =
      u.col(nearest_node(model.mesh, {0.1, 0.1, 0.1})) / 0.1 + Vector3d::Ones();
  CHECK(stretch[2] == Approx(0.8).epsilon(tolerance(1e-9, "the lid's entry")));
  CHECK((u - (stretch - Vector3d::Ones()).asDiagonal() * model.mesh.nodes).cwiseAbs().maxCoeff() <=
        tolerance(1e-10, "m; the tolerance of the residual"));
  // Uniaxial stress: none across, and the force is the axial stress times the face.
  const Eigen::Matrix3d P = first_piola(model.material, stretch.asDiagonal());
  CHECK(std::abs(P(0, 0)) <= tolerance(1e-4, "Pa of 4000"));
  CHECK(walk.now().force[2] == Approx(P(2, 2) * 0.01).epsilon(tolerance(1e-8, "as the stretch")));
}

TEST_CASE("a ball on a block has Hertz's force, radius and pressure, in second order of the mesh",
          "[solid][contact][hertz]") {
  const HertzResult coarse = press_hertz_block(8);
  const HertzResult fine = press_hertz_block(12);
  CHECK(std::abs(fine.force_error) < tolerance(0.12, "six cells across the contact radius"));
  CHECK(std::abs(fine.radius_error) < tolerance(0.05, "the same"));
  CHECK(std::abs(fine.pressure_error) < tolerance(0.15, "the same"));
  const double order =
      std::log(coarse.force_error / fine.force_error) / std::log(coarse.cell / fine.cell);
  CHECK(order > tolerance(1.6, "linear elements: 2 as the mesh gets finer"));
  CHECK(order < 2.5);
}

TEST_CASE("the obstacle's force is the slope of the body's energy along its way",
          "[solid][contact]") {
  const EquilibriumSolver solver(block(6));
  ContactWalk walk(solver, ball_at, -0.001, {.tolerance = 1e-10});
  REQUIRE(walk.advance(0.005));
  check_conditions(walk);
  const double force = walk.now().force[2];
  const auto energy = [&](double t) {
    ContactWalk other(solver, ball_at, -0.001, {.tolerance = 1e-10});
    REQUIRE(other.advance(t));
    return other.now().energy;
  };
  // t is the depth: the obstacle moves along -z and does the work -force.z dt.
  const double slope = (energy(0.00501) - energy(0.00499)) / 2e-5;
  CHECK(-force == Approx(slope).epsilon(tolerance(1e-4, "differences over 0.4 % of the depth")));
}

// A lid that moves down by 4 mm onto the block's top until t = 1, then sideways by 1 m per unit of
// time.
Obstacle lid_at(double t) {
  const double down = 0.1 - 0.004 * std::min(t, 1.0), aside = std::max(0.0, t - 1.0);
  return {.half_spaces = {{{aside, 0, down}, {0, 0, -1}}}};
}

TEST_CASE("a lid that goes aside drags a block along until it slides by Coulomb's law",
          "[solid][contact]") {
  const EquilibriumSolver solver(block(4));
  const auto top = nodes_on_plane(block(4).mesh, {0, 0, 0.1}, {0, 0, 1}, 1e-9);
  // Where it sticks, the top moves with the lid.
  ContactWalk sticks(solver, lid_at, -0.1, {.friction = 5.0});
  REQUIRE(sticks.advance(0.5));
  REQUIRE(sticks.advance(1.0));
  const Matrix3Xd pressed = sticks.now().displacement;
  REQUIRE(sticks.advance(1.002));
  check_conditions(sticks);
  const double held = 1e-4 * sticks.body_size();
  for (const int node : top) {
    const Vector3d moved = sticks.now().displacement.col(node) - pressed.col(node);
    CHECK((moved - Vector3d(0.002, 0, 0)).norm() <= tolerance(held, "the elastic slip"));
  }
  // Where it slides, the friction force is mu times the normal force.
  ContactWalk slides(solver, lid_at, -0.1, {.friction = 0.3});
  REQUIRE(slides.advance(1.0));
  for (int i = 1; i <= 8; ++i) REQUIRE(slides.advance(1.0 + 0.004 * i));
  check_conditions(slides);
  const Vector3d force = slides.now().force;
  CHECK(force[2] < 0);
  CHECK(force[0] == Approx(-0.3 * force[2]).epsilon(tolerance(1e-3, "points slide aside by 1 %")));
  CHECK(std::abs(force[1]) < tolerance(1e-3, "the block is symmetric") * force.norm());
  // Sliding is steady: the displacement does not change any more.
  const Matrix3Xd before = slides.now().displacement;
  REQUIRE(slides.advance(1.036));
  CHECK((slides.now().displacement - before).norm() <=
        tolerance(1e-3, "the last steps' way across") * before.norm());
}

TEST_CASE("a point that begins to press within a step rubs from there on",
          "[solid][contact][friction]") {
  // The lid touches a quarter of the way through its one step, down and aside at once.
  const EquilibriumSolver solver(block(3));
  const auto lid = [](double t) {
    return Obstacle{.half_spaces = {{{0.001 * t, 0, 0.101 - 0.004 * t}, {0, 0, -1}}}};
  };
  ContactWalk walk(solver, lid, 0.0, {.friction = 20.0});
  REQUIRE(walk.advance(1.0));
  check_conditions(walk);
  CHECK(walk.now().sticking == walk.now().touching);
  CHECK(walk.now().sticking_area == walk.now().touching_area);
  // Points on the rim have a share of the sides, too.
  CHECK(walk.now().touching_area > 0.0099);
  CHECK(walk.now().touching_area < 0.014);
  CHECK(walk.now().dissipated == 0.0);
  const auto top = nodes_on_plane(block(3).mesh, {0, 0, 0.1}, {0, 0, 1}, 1e-9);
  for (const int node : top) {
    const Vector3d moved = walk.now().displacement.col(node);
    // The lid took the point along from where it touched it, at rest.
    CHECK((moved - Vector3d(0.00075, 0, -0.003)).norm() <= tolerance(2e-5, "m; the elastic slip"));
  }
}

TEST_CASE("friction that begins later holds the skin where it is then",
          "[solid][contact][friction]") {
  const SolidModel model = block(3);
  const EquilibriumSolver solver(model);
  ContactWalk walk(solver, lid_at, -0.1);
  REQUIRE(walk.advance(1.0));
  const Matrix3Xd pressed = walk.now().displacement;
  const double pressing = walk.now().force.z();
  walk.set_friction(20.0);
  REQUIRE(walk.advance(1.001));
  check_conditions(walk);
  CHECK(walk.now().sticking == walk.now().touching);
  const auto top = nodes_on_plane(model.mesh, {0, 0, 0.1}, {0, 0, 1}, 1e-9);
  for (const int node : top) {
    const Vector3d moved = walk.now().displacement.col(node) - pressed.col(node);
    CHECK((moved - Vector3d(0.001, 0, 0)).norm() <=
          tolerance(1e-4 * walk.body_size(), "the elastic slip"));
  }
  // Without it the lid slides, and what it held is let go.
  walk.set_friction(0.0);
  REQUIRE(walk.advance(1.003));
  CHECK(std::abs(walk.now().force.x()) <= tolerance(1e-6, "tolerance of the state") * -pressing);
  CHECK(walk.now().sticking == 0);
  const Matrix3Xd free = walk.now().displacement;
  // With it again, the way in between is forgotten.
  walk.set_friction(20.0);
  REQUIRE(walk.advance(1.004));
  for (const int node : top) {
    const Vector3d moved = walk.now().displacement.col(node) - free.col(node);
    CHECK((moved - Vector3d(0.001, 0, 0)).norm() <=
          tolerance(1e-4 * walk.body_size(), "the elastic slip"));
  }
}

TEST_CASE("states that are only passed lead to the same state as exact ones",
          "[solid][contact][friction]") {
  const EquilibriumSolver solver(block(4));
  const auto drag = [](double t) {
    Obstacle dragged = ball_at(std::min(t, 0.006));
    dragged.capsules[0].a.x() += std::max(0.0, t - 0.006);
    dragged.capsules[0].b.x() = dragged.capsules[0].a.x();
    return dragged;
  };
  ContactWalk exact(solver, drag, -1e-3, {.friction = 0.3});
  ContactWalk rough(solver, drag, -1e-3, {.friction = 0.3});
  ContactWalk shorter(solver, drag, -1e-3, {.friction = 0.3});
  for (int i = 1; i <= 11; ++i) {
    REQUIRE(exact.advance(1e-3 * i));
    REQUIRE(rough.pass(1e-3 * i));
    REQUIRE(shorter.advance(1e-3 * i - 0.5e-3));
    REQUIRE(shorter.advance(1e-3 * i));
  }
  REQUIRE(exact.advance(0.012));
  REQUIRE(rough.advance(0.012));
  REQUIRE(shorter.advance(0.0115));
  REQUIRE(shorter.advance(0.012));
  check_conditions(rough);
  ContactWalk again(solver, drag, -1e-3, {.friction = 0.3});
  ContactWalk at_once(solver, drag, -1e-3, {.friction = 0.3});
  REQUIRE(again.pass(0.004));
  REQUIRE(at_once.advance(0.004));
  CHECK(again.now().newton_steps < at_once.now().newton_steps);
  const Matrix3Xd passed = again.now().displacement;
  REQUIRE(again.advance(0.004));
  check_conditions(again);
  CHECK(again.now().displacement != passed);
  const Matrix3Xd& u = exact.now().displacement;
  const double by_passing = (rough.now().displacement - u).norm() / u.norm();
  const double by_step = (shorter.now().displacement - u).norm() / u.norm();
  CAPTURE(by_passing, by_step);
  CHECK(by_passing <= tolerance(0.1, "far less than half the step") * by_step);
}

TEST_CASE("an obstacle passes through skin that is held, and presses what is not",
          "[solid][contact]") {
  // A ball comes from aside, level with the held base: deepest inside it, less so above.
  const EquilibriumSolver solver(block(5));
  const auto aside = [](double t) {
    return Obstacle{.capsules = {ball({-0.05 + t, 0.05, 0.0}, 0.05)}};
  };
  for (const double friction : {0.0, 0.3}) {
    CAPTURE(friction);
    ContactWalk walk(solver, aside, -1e-3, {.friction = friction});
    REQUIRE(walk.advance(0.002));
    REQUIRE(walk.advance(0.004));
    check_conditions(walk);
    CHECK(walk.now().touching > 0);
    CHECK(walk.now().force.x() > 0);
    CHECK(walk.now().held_entry == Approx(0.004).epsilon(tolerance(0.05, "the spacing of points")));
    for (const int node : block(5).fixed_nodes) {
      CHECK(walk.now().displacement.col(node) == Vector3d(0, 0, 0));
    }
  }
}

TEST_CASE("a turned problem has the turned solution, with friction as well",
          "[solid][contact][friction]") {
  const auto end_state = [](const Rigid3& turn) {
    SolidModel model = block(4);
    for (int n = 0; n < model.mesh.node_count(); ++n) {
      model.mesh.nodes.col(n) = turn * Vector3d(model.mesh.nodes.col(n));
    }
    const EquilibriumSolver solver(model);
    // A capsule that goes down, then aside, and turns about the vertical meanwhile.
    const auto way = [&turn](double t) {
      const double down = std::min(t, 6e-3), aside = std::max(0.0, t - 6e-3);
      Rigid3 placed = Rigid3::Identity();
      placed.translate(Vector3d(0.046 + aside, 0.048, 0.12 - down));
      placed.rotate(Eigen::AngleAxisd(20.0 * aside, Vector3d::UnitZ()));
      const Obstacle stick{.capsules = {{{-0.01, 0, 0}, {0.015, 0, 0}, 0.02, 0.02}}};
      return moved(stick, turn * placed);
    };
    ContactWalk walk(solver, way, -1e-4, {.spacing = 0.008, .friction = 0.3});
    for (int k = 1; k <= 8; ++k) REQUIRE(walk.advance(1.5e-3 * k));
    return Matrix3Xd(turn.linear().transpose() * walk.now().displacement);
  };
  const Matrix3Xd straight = end_state(Rigid3::Identity());
  double nearest = 1;
  for (const double angle : {0.2, 0.5, 0.6, 0.7, 1.1}) {
    Rigid3 turn = Rigid3::Identity();
    turn.rotate(Eigen::AngleAxisd(angle, Vector3d(1, 2, -1).normalized()));
    const double apart = (end_state(turn) - straight).norm() / straight.norm();
    CHECK(apart <= tolerance(0.01, "rounding decides whether a point sticks or slides; 0.0057"));
    nearest = std::min(nearest, apart);
  }
  CHECK(nearest <= tolerance(5e-4, "states are solved to 1e-6 of the size, step by step"));
}

TEST_CASE("without friction nothing sticks, and nothing is dissipated",
          "[solid][contact][friction]") {
  const EquilibriumSolver solver(block(3));
  ContactWalk walk(solver, lid_at, -0.1);
  REQUIRE(walk.advance(1.0));
  REQUIRE(walk.advance(1.002));
  CHECK(walk.now().sticking == 0);
  CHECK(walk.now().dissipated == 0.0);
  CHECK(walk.now().force.head<2>().norm() <= 1e-9 * walk.now().force.norm());
}

TEST_CASE("many steps, few steps and the way back lead to the same state", "[solid][contact]") {
  const EquilibriumSolver solver(block(6));
  ContactWalk few(solver, ball_at, -0.001), many(solver, ball_at, -0.001);
  REQUIRE(few.advance(0.012));
  for (int i = 1; i <= 8; ++i) REQUIRE(many.advance(0.016 * i / 8));
  for (int i = 7; i >= 6; --i) REQUIRE(many.advance(0.016 * i / 8));
  check_conditions(few);
  check_conditions(many);
  const double size = few.now().displacement.norm();
  CHECK((few.now().displacement - many.now().displacement).norm() <=
        tolerance(1e-4, "of the norm; both are solved to 1e-6 of the size") * size);
  REQUIRE(many.advance(-0.001));
  CHECK(many.now().touching == 0);
  CHECK(many.now().force.norm() == 0.0);
  CHECK(many.now().displacement.norm() <= tolerance(1e-6, "released, it is at rest") * size);
}

TEST_CASE("a closed surface presses as the half space or the ball that it stands for",
          "[solid][contact]") {
  const EquilibriumSolver solver(block(4));
  const auto face =
      std::make_shared<const SurfaceDistance>(box_surface({-0.05, -0.05, 0.1}, {0.15, 0.15, 0.2}));
  const auto box = [&](double t) {
    Rigid3 pose = Rigid3::Identity();
    pose.translation().z() = -t;
    return Obstacle{.surfaces = {{face, pose}}};
  };
  const auto lid = [](double t) {
    return Obstacle{.half_spaces = {{{0, 0, 0.1 - t}, {0, 0, -1}}}};
  };
  ContactWalk a(solver, box, -0.001), b(solver, lid, -0.001);
  REQUIRE(a.advance(0.01));
  REQUIRE(b.advance(0.01));
  check_conditions(a);
  CHECK((a.now().displacement - b.now().displacement).norm() <=
        tolerance(1e-5, "both are solved to 1e-6 of the size") * b.now().displacement.norm());
  CHECK(a.now().force[2] == Approx(b.now().force[2]).epsilon(1e-5));
}

TEST_CASE("things that come and go elsewhere change nothing, with friction and without",
          "[solid][contact][friction]") {
  const double friction = GENERATE(0.0, 0.3);
  const EquilibriumSolver solver(block(4));
  // Not smaller than the ball, because the smallest radius sets the distance between contact
  // points.
  const Capsule far = ball({0.05, 0.05, 0.5}, 0.05);
  // The ball is the third of three, then alone, then the first of two.
  const auto with_others = [&](double t) {
    Obstacle obstacle = ball_at(t);
    std::vector<Capsule>& all = obstacle.capsules;
    if (t < 0.004) all.insert(all.begin(), 2, far);
    if (t > 0.007) all.push_back(far);
    return obstacle;
  };
  const ContactSettings settings{.friction = friction};
  ContactWalk alone(solver, ball_at, -0.001, settings),
      among(solver, with_others, -0.001, settings);
  for (const double t : {0.003, 0.005, 0.006, 0.008, 0.003, 0.006}) {
    INFO(t);
    REQUIRE(alone.advance(t));
    REQUIRE(among.advance(t));
    check_conditions(among);
    const double size = alone.now().displacement.norm();
    const double most = friction > 0.0 ? tolerance(1e-3, "what slips depends on the path so far")
                                       : tolerance(1e-4, "both are solved to 1e-6 of the size");
    CHECK((alone.now().displacement - among.now().displacement).norm() <= most * size);
  }
}

TEST_CASE("a tip smaller than a triangle touches inside it, and spacing bounds what enters between",
          "[solid][contact]") {
  const EquilibriumSolver solver(block(4));  // edges of 25 mm
  const auto pencil = [](double t) {
    return Obstacle{.capsules = {{{0.045, 0.04, 0.1012 - t}, {0.045, 0.04, 0.2}, 1.2e-3, 4e-3}}};
  };
  double before = std::numeric_limits<double>::infinity();
  for (const double spacing : {0.0, 1e-3, 0.5e-3}) {
    ContactWalk walk(solver, pencil, -0.001, {.spacing = spacing});
    REQUIRE(walk.advance(0.006));
    check_conditions(walk);
    if (spacing == 0.0) {
      CHECK(walk.spacing() == Approx(0.6e-3));
      CHECK(walk.now().entry_between <= 2e-4);
      continue;
    }
    CHECK(walk.now().entry_between < before);
    before = walk.now().entry_between;
  }
  CHECK(before < 1e-4);
}

TEST_CASE("what presses from two sides presses with opposite forces", "[solid][contact]") {
  const EquilibriumSolver solver(block(5));
  const auto squeeze = [](double t) {
    return Obstacle{
        .capsules = {ball({-0.02 + t, 0.05, 0.06}, 0.02), ball({0.12 - t, 0.05, 0.06}, 0.02)}};
  };
  ContactWalk walk(solver, squeeze, -0.001);
  REQUIRE(walk.advance(0.01));
  check_conditions(walk);
  CHECK(std::abs(walk.now().force[0]) < 0.05 * walk.nodal_forces().colwise().norm().sum());
  CHECK(walk.now().touching >= 2);
}

TEST_CASE("a ball never gets through the skin, however long its steps", "[solid][contact]") {
  // On a slab much wider than the ball; at the end its middle would lie below the slab's top, so
  // that one long step could leave it inside, where no skin is near.
  const EquilibriumSolver solver(block(5));
  const auto down = [](double t) {
    return Obstacle{.capsules = {ball({0.05, 0.05, 0.11 - t}, 0.008)}};
  };
  ContactWalk one(solver, down, 0.0), many(solver, down, 0.0);
  REQUIRE(one.advance(0.018));
  for (int i = 1; i <= 9; ++i) REQUIRE(many.advance(0.002 * i));
  check_conditions(one);
  CHECK(one.now().touching > 0);
  CHECK(one.now().force.z() < 0.0);
  CHECK(one.now().force.z() == Approx(many.now().force.z()).epsilon(1e-4));

  const auto inside = [](double) {
    return Obstacle{.capsules = {ball({0.05, 0.05, 0.05}, 0.008)}};
  };
  ContactWalk lost(solver, inside, 0.0);
  CHECK_FALSE(lost.advance(1.0));
  CHECK(lost.stop() == Stop::kSwallowed);
  CHECK(lost.why_stopped() == "the obstacle lies inside the body where its way begins");
}

TEST_CASE("a grid that no memory holds is refused", "[solid][contact][errors]") {
  const EquilibriumSolver solver(block(2));
  CHECK_THROWS_WITH(ContactWalk(solver, ball_at, 0.0, {.spacing = 1e-6}),
                    Catch::Matchers::Contains("ask for a larger spacing"));
}

TEST_CASE("an obstacle that would crush the body ends the way with the reason",
          "[solid][contact]") {
  const EquilibriumSolver solver(block(4));
  const auto lid = [](double t) {
    return Obstacle{.half_spaces = {{{0, 0, 0.1 - t}, {0, 0, -1}}}};
  };
  ContactWalk walk(solver, lid, -0.001);
  CHECK_FALSE(walk.advance(0.12));
  CHECK(walk.now().t < 0.1);
  CHECK_FALSE(walk.why_stopped().empty());
  // The walk can continue from the last good state.
  const double good = walk.now().t;
  INFO("from " << good);
  CHECK(walk.advance(good - 0.002));
  CHECK(walk.why_stopped().empty());
  check_conditions(walk);
}

}  // namespace
}  // namespace palpable
