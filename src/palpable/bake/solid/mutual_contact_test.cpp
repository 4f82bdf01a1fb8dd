// Bodies that press each other, solved together: blocks against the closed form, beams against beam
// theory.
#include "palpable/bake/solid/contact.h"
#include "palpable/bake/solid/joined_model.h"
#include "palpable/bake/solid/selection.h"
#include "tests/support/small_beam.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

Obstacle nothing(double /*t*/) { return {}; }

Rigid3 at(double x, double y, double z) {
  Rigid3 pose = Rigid3::Identity();
  pose.translation() = Vector3d(x, y, z);
  return pose;
}

void check_conditions(const ContactWalk& walk, double entry = 1e-6) {
  const ContactState& state = walk.now();
  CHECK(state.smallest_mutual_gap >= -entry * walk.body_size());
  const bool presses = state.touching > 0 || state.mutual_touching > 0;
  if (presses) CHECK(state.residual <= 1e-7);
  const double sum = walk.mutual_nodal_forces().colwise().norm().sum();
  CHECK(state.mutual_force.rowwise().sum().norm() <= tolerance(1e-12, "rounding") * (1e-9 + sum));
  CHECK((state.mutual_touching > 0) == (sum > 0.0));
}

// A cube of 0.1 m and 20 kPa that slides along the planes x = 0, y = 0 and z = 0 (or z = 0.1, its
// top).
SolidModel sliding_block(int cells, bool on_top) {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, cells, cells, cells);
  model.material = material_from_young("neo-hookean", 20e3, 0.3);
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d through = axis == 2 && on_top ? Vector3d(0, 0, 0.1) : Vector3d::Zero();
    Support slides{.node = 0, .held = {axis == 0, axis == 1, axis == 2}};
    for (const int node : nodes_on_plane(model.mesh, through, Vector3d::Unit(axis), 1e-9)) {
      slides.node = node;
      model.supports.push_back(slides);
    }
  }
  return model;
}

TEST_CASE("two blocks pushed into each other shorten as one that is twice as high",
          "[solid][mutual]") {
  for (const int other_cells : {3, 4}) {  // the same grid, and another
    INFO("cells " << other_cells);
    const std::array<SolidModel, 2> blocks{sliding_block(3, false),
                                           sliding_block(other_cells, true)};
    const double into = 0.016;  // m
    const JoinedModel both = joined(blocks, std::array{at(0, 0, 0), at(0, 0, 0.1 - into)});
    const EquilibriumSolver solver(both.model);
    ContactWalk walk(solver, nothing, 0.0,
                     {.tolerance = 1e-9, .largest_entry = 1e-9, .mutual = true});
    const bool reached = walk.advance(1.0);
    INFO(walk.why_stopped());
    REQUIRE(reached);
    check_conditions(walk);
    CHECK(walk.now().smallest_mutual_gap >= -1e-9);
    CHECK(walk.now().touching == 0);
    // Both end 0.092 m high, uniformly deformed and without transverse stress.
    const Matrix3Xd& u = walk.now().displacement;
    const Matrix3Xd& X = both.model.mesh.nodes;
    const double height = 1.0 - 0.5 * into / 0.1;
    double wide = 1.0;  // by Newton's method on the transverse stress
    for (int i = 0; i < 20; ++i) {
      const auto across = [&](double w) {
        return first_piola(blocks[0].material, Vector3d(w, w, height).asDiagonal())(0, 0);
      };
      wide -= across(wide) * 1e-6 / (across(wide + 1e-6) - across(wide));
    }
    for (int n = 0; n < both.model.mesh.node_count(); ++n) {
      const double base = n < both.first_node[1] ? 0.0 : 0.2 - into;
      const double z = n < both.first_node[1] ? X(2, n) : X(2, n) - (0.2 - into);
      const Vector3d expected(wide * X(0, n), wide * X(1, n), base + height * z);
      CHECK((X.col(n) + u.col(n) - expected).norm() <=
            tolerance(1e-8, "m; the largest entry is 3e-10"));
    }
    const double stress =
        first_piola(blocks[0].material, Vector3d(wide, wide, height).asDiagonal())(2, 2);
    const Matrix3Xd& force = walk.now().mutual_force;
    REQUIRE(force.cols() == 2);
    CHECK(force(2, 0) == Approx(stress * 0.01).epsilon(tolerance(1e-6, "as the field")));
    CHECK(force(2, 1) == Approx(-stress * 0.01).epsilon(tolerance(1e-6, "as the field")));
    CHECK(force.topRows(2).cwiseAbs().maxCoeff() <=
          tolerance(1e-6, "no friction") * std::abs(force(2, 0)));
  }
}

TEST_CASE("bodies that do not touch answer an obstacle as if each were alone", "[solid][mutual]") {
  const std::array<SolidModel, 2> beams{test::small_beam(8, 2, 1), test::small_beam(8, 2, 1)};
  const EquilibriumSolver both(joined(beams, std::array{at(0, 0, 0), at(0, 0, 0.2)}).model);
  const EquilibriumSolver lower(beams[0]);
  const auto from_below = [](double t) {
    return Obstacle{.capsules = {{{0.35, -0.1, -0.02 + t}, {0.35, 0.2, -0.02 + t}, 0.02, 0.02}}};
  };
  ContactWalk together(both, from_below, -0.001, {.mutual = true}),
      alone(lower, from_below, -0.001);
  REQUIRE(together.advance(0.02));
  REQUIRE(alone.advance(0.02));
  check_conditions(together);
  CHECK(together.now().mutual_force.norm() == 0.0);
  CHECK(std::isinf(together.now().smallest_mutual_gap));
  const int N = beams[0].mesh.node_count();
  CHECK((together.now().displacement.leftCols(N) - alone.now().displacement).norm() <=
        tolerance(1e-5, "both are solved to 1e-6 of the size") * alone.now().displacement.norm());
  CHECK(together.now().displacement.rightCols(N).norm() == 0.0);
  CHECK(alone.now().mutual_force.cols() == 0);
}

// Two small beams one above the other, 10 mm apart, and a capsule across the upper one near its tip
// that comes down by t, m.
constexpr double kApart = 0.010, kAt = 0.36;

struct StackedBeams {
  std::array<SolidModel, 2> beams;
  JoinedModel both;
  StackedBeams(int nx, int ny, int nz, double aside = 0.0)
      : beams{test::small_beam(nx, ny, nz), test::small_beam(nx, ny, nz)},
        both(joined(beams, std::array{at(0, 0, 0), at(0, aside, 0.05 + kApart)})) {}

  static Obstacle capsule(double t) {
    const double z = 0.10 + kApart + 0.015 - t;
    return {.capsules = {{{kAt, -0.05, z}, {kAt, 0.15, z}, 0.015, 0.015}}};
  }
  // Deflection, m, of the node in the middle of the underside of a body, below the capsule.
  [[nodiscard]] double sag(const ContactState& state, int body) const {
    const double z = body == 0 ? 0.0 : 0.05 + kApart;
    const int node = nearest_node(both.model.mesh, {kAt, 0.05, z});
    return -state.displacement(2, node);
  }
};

// Presses the upper beam until it lies on the lower one, then releases it. The stiffness of one
// beam is measured, so that beam theory is used only for what it predicts well: how two beams share
// a load.
void press_and_release(int nx, int ny, int nz, double aside) {
  const StackedBeams stack(nx, ny, nz, aside);
  const EquilibriumSolver solver(stack.both.model);
  ContactWalk walk(solver, StackedBeams::capsule, -0.001, {.mutual = true});
  const auto go = [&](double t) {
    const bool reached = walk.advance(t);
    INFO(t << ": " << walk.why_stopped());
    REQUIRE(reached);
    check_conditions(walk);
  };
  go(0.008);
  const double spring = -walk.now().force.z() / 0.008;  // N/m, of the upper alone
  CHECK(walk.now().mutual_touching == 0);
  CHECK(std::abs(stack.sag(walk.now(), 0)) <= tolerance(1e-7, "m; the residual"));
  for (const double t : {0.013, 0.019, 0.025}) go(t);
  const ContactState pressed = walk.now();
  CHECK(pressed.smallest_gap >= -1e-6 * walk.body_size());
  CHECK(pressed.mutual_touching > 0);
  const double between = -pressed.mutual_force(2, 0);
  CHECK(between > 0.0);
  CHECK(pressed.mutual_force(2, 1) == Approx(between).epsilon(1e-9));
  const double upper = stack.sag(pressed, 1), lower = stack.sag(pressed, 0);
  CHECK(upper > lower);
  CHECK(lower > 0.005);
  // Euler and Bernoulli: the upper's tip reaches the lower first, as its slope ends there. Under a
  // force F at a = 0.36 it bends by F a^3 / (3 E I) there and by (1 + 3 (L - a) / (2 a)) times that
  // at its tip L; pushed at the tip by R, the lower's tip sags by R L^3 / (3 E I) and the upper
  // rises at a by R a^2 (3 L - a) / (6 E I).
  const double a = kAt, L = 0.40, ratio = 1.0 + 1.5 * (L - a) / a;
  const double c_aa = 1.0, c_aL = ratio, c_LL = L * L * L / (a * a * a);  // a^3 / (3 E I) each
  // t = c_aa F - c_aL R and c_aL F - c_LL R = kApart + c_LL R
  const double t = 0.025;
  const double R = (c_aL * t / c_aa - kApart) / (2.0 * c_LL - c_aL * c_aL / c_aa) * spring;
  const double F = spring * t / c_aa + c_aL / c_aa * R;
  INFO("between " << between << " N, beam theory " << R << "; pressing " << -pressed.force.z()
                  << ", " << F);
  CHECK(between == Approx(R).epsilon(tolerance(0.1, "slopes of 0.1, dents where they touch")));
  CHECK(-pressed.force.z() == Approx(F).epsilon(tolerance(0.1, "the same")));

  for (const double back : {0.012, -0.001}) go(back);
  CHECK(walk.now().touching == 0);
  CHECK(walk.now().mutual_touching == 0);
  CHECK(walk.now().displacement.norm() <=
        tolerance(1e-5, "released, both are at rest") * pressed.displacement.norm());
}

TEST_CASE("a beam pressed onto another bends it, by beam theory, and both come back",
          "[solid][mutual][long]") {
  press_and_release(8, 2, 1, 0.0);
}

TEST_CASE("so does one on a finer mesh, and one that lies a little aside",
          "[solid][mutual][long]") {
  press_and_release(16, 4, 2, 0.0);
  press_and_release(24, 6, 3, 0.013);
}

// A soft cube on the ground, pressed by 4 mm under a stiff one that is held at its top: the soft
// one spreads. @returns the largest movement aside of its top, m
double largest_slide(double friction, ContactState& state) {
  std::array<SolidModel, 2> blocks{sliding_block(3, false), sliding_block(4, true)};
  blocks[0].material = material_from_young("neo-hookean", 20e3, 0.4);
  blocks[1].material = material_from_young("neo-hookean", 2e6, 0.1);
  const SolidModel& cube = blocks[0];
  const JoinedModel both = joined(blocks, std::array{at(0, 0, 0), at(0, 0, 0.1 - 0.004)});
  const EquilibriumSolver solver(both.model);
  ContactWalk walk(solver, nothing, 0.0, {.mutual = true, .mutual_friction = friction});
  const bool reached = walk.advance(1.0);
  INFO(walk.why_stopped());
  REQUIRE(reached);
  check_conditions(walk, 5e-6);
  state = walk.now();
  double largest = 0.0;
  for (const int n : nodes_on_plane(cube.mesh, {0, 0, 0.1}, Vector3d::UnitZ(), 1e-9)) {
    largest = std::max(largest, state.displacement.col(n).head<2>().norm());
  }
  return largest;
}

TEST_CASE("friction between two bodies holds what would slide, up to Coulomb's force",
          "[solid][mutual][friction]") {
  ContactState free, rubs, sticks;
  const double without = largest_slide(0.0, free);
  const double some = largest_slide(0.05, rubs);
  const double none = largest_slide(3.0, sticks);
  CHECK(without > 5e-4);
  CHECK(some < 0.98 * without);
  CHECK(none <=
        tolerance(1e-4, "m; elastic slip; the plate, 100 times as stiff, gives way a little"));
  CHECK(free.dissipated == 0.0);
  CHECK(rubs.dissipated > 0.0);
  CHECK(sticks.dissipated <= tolerance(1e-3, "nothing slides") * rubs.dissipated);
  CHECK(sticks.sticking > 0.9 * sticks.mutual_touching);
  CHECK(rubs.sticking < rubs.mutual_touching);
}

TEST_CASE("a bar that is dragged over a block rubs with Coulomb's force, step after step",
          "[solid][mutual][friction]") {
  SolidModel base;
  base.mesh = box_tets({-0.1, 0, 0}, {0.2, 0.1, 0.06}, 9, 3, 2);
  base.material = material_from_young("neo-hookean", 40e3, 0.3);
  base.fixed_nodes = nodes_on_plane(base.mesh, {0, 0, 0}, Vector3d::UnitZ(), 1e-9);
  SolidModel bar;  // held at its far end
  bar.mesh = box_tets({-0.3, 0.01, 0}, {0.15, 0.09, 0.03}, 17, 4, 2);
  bar.material = material_from_young("neo-hookean", 80e3, 0.3);
  bar.fixed_nodes = nodes_on_plane(bar.mesh, {-0.3, 0, 0}, Vector3d::UnitX(), 1e-9);
  const JoinedModel both =
      joined(std::array{base, bar}, std::array{at(0, 0, 0), at(0, 0, 0.06 + 1e-4)});
  const EquilibriumSolver solver(both.model);
  // A ball that sticks to the bar goes down by 6 mm, then along it by 4.5 mm.
  const auto drags = [](double t) {
    const double down = std::min(t, 6e-3), along = std::max(0.0, t - 6e-3);
    return Obstacle{.capsules = {ball({0.04 + along, 0.05, 0.0901 + 0.15 - down}, 0.15)}};
  };
  ContactWalk walk(solver, drags, -1e-3,
                   {.friction = 20.0, .mutual = true, .mutual_friction = 0.3});
  double largest = 0.0;
  for (int k = 1; k <= 7; ++k) {
    const bool reached = walk.advance(1.5e-3 * k);
    INFO(walk.why_stopped());
    REQUIRE(reached);
    const Vector3d force = walk.now().mutual_force.col(0);  // on the block
    if (k >= 4) largest = std::max(largest, std::hypot(force.x(), force.y()) / -force.z());
    CHECK(walk.now().cone_error <= tolerance(1e-3, "the limit of the cone is an update late"));
  }
  const Vector3d force = walk.now().mutual_force.col(0);
  CHECK(force.x() > 0.0);
  CHECK(largest <= 0.3);
  CHECK(force.x() / -force.z() ==
        Approx(0.3).epsilon(tolerance(0.02, "the dent's sides; points that still stick")));
}

TEST_CASE("a body that lies deep in another is refused", "[solid][mutual]") {
  const std::array<SolidModel, 2> blocks{sliding_block(2, false), sliding_block(4, false)};
  SolidModel small = blocks[1];
  small.mesh.nodes *= 0.2;
  const EquilibriumSolver solver(
      joined(std::array{blocks[0], small}, std::array{at(0, 0, 0), at(0.04, 0.04, 0.04)}).model);
  ContactWalk walk(solver, nothing, 0.0, {.mutual = true});
  CHECK_FALSE(walk.advance(1.0));
}

}  // namespace
}  // namespace palpable
