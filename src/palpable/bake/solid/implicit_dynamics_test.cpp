#include "palpable/bake/solid/implicit_dynamics.h"

#include "palpable/bake/solid/contact.h"
#include "palpable/bake/solid/load_response.h"
#include "palpable/bake/solid/selection.h"
#include "palpable/bake/solid/vibration_modes.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::tolerance;

constexpr double kDensity = 1070;  // kg/m^3

// A cantilever along X of 10-node tetrahedra, 200 x 16 x 10 mm, with its modes.
struct Cantilever {
  SolidModel model;
  Eigen::SparseMatrix<double> M;
  VibrationModes modes;
  int tip = 0;  // a node at the free end

  explicit Cantilever(const std::string& law = "saint-venant-kirchhoff") {
    model.mesh = with_edge_nodes(box_tets({0, 0, 0}, {0.2, 0.016, 0.01}, 8, 1, 1));
    model.material = material_from_young(law, 1e6, 0.3);
    model.fixed_nodes = nodes_on_plane(model.mesh, {0, 0, 0}, {1, 0, 0}, 1e-12);
    M = consistent_mass(model.mesh, kDensity);
    modes = vibration_modes(LoadResponse(model), kDensity, {.least = 6, .below = 0});
    tip = nodes_on_plane(model.mesh, {0.2, 0, 0}, {1, 0, 0}, 1e-9).front();
  }

  [[nodiscard]] int nodes() const { return model.mesh.node_count(); }
  [[nodiscard]] Matrix3Xd nothing() const { return Matrix3Xd::Zero(3, nodes()); }
  [[nodiscard]] Matrix3Xd shape(Index k) const {
    return Eigen::Map<const Matrix3Xd>(modes.shapes.col(k).data(), 3, nodes());
  }
  [[nodiscard]] ModalDamping damping(double ratio) const {
    return {modes.omega, modes.shapes, ratio};
  }
  // The amplitude of mode k in the displacement u.
  [[nodiscard]] double amplitude(Index k, const Matrix3Xd& u) const {
    return (shape(k) * M).cwiseProduct(u).sum();
  }
  // (3 x N) N, a force at the tip.
  [[nodiscard]] Matrix3Xd at_tip(const Vector3d& force) const {
    Matrix3Xd load = nothing();
    load.col(tip) = force;
    return load;
  }
};

// So small that the body is linear, so large that rounding of forces is not felt: displacements of
// up to 1e-6 m, slopes of up to 4e-5. Turning couples a shape to others by a share of the size of
// its slope, and changes its own motion by the square of that.
constexpr double kTiny = 1e-7;  // m sqrt(kg)

// The generalised-alpha method for q'' + 2 zeta omega q' + omega^2 q = g, written anew for a
// number.
struct ScalarMotion {
  double omega, zeta, h, rho;
  double q = 0, v = 0, a = 0;

  void step(double g) {
    const double am = (2 * rho - 1) / (rho + 1), af = rho / (rho + 1);
    const double gamma = 0.5 - am + af, beta = std::pow(1 - am + af, 2) / 4;
    const double q_0 = q + h * v + h * h * (0.5 - beta) * a, v_0 = v + h * (1 - gamma) * a;
    const double known = am * a + 2 * zeta * omega * ((1 - af) * v_0 + af * v) +
                         omega * omega * ((1 - af) * q_0 + af * q);
    const double factor =
        1 - am + 2 * zeta * omega * (1 - af) * gamma * h + omega * omega * (1 - af) * beta * h * h;
    const double a_1 = (g - known) / factor;
    q = q_0 + beta * h * h * a_1;
    v = v_0 + gamma * h * a_1;
    a = a_1;
  }
};

TEST_CASE("a mode that is started with its shape moves as one oscillator does",
          "[solid][dynamics]") {
  const Cantilever body;
  for (const double rho : {0.0, 0.8, 1.0}) {
    for (const double zeta : {0.0, 0.075}) {
      for (const Index k : {0, 3, 5}) {
        INFO("rho_inf " << rho << ", zeta " << zeta << ", mode " << k);
        const double omega = body.modes.omega[k];
        const double h = 2 * std::numbers::pi / omega / 40;
        ImplicitDynamics dynamics(body.model, kDensity, body.damping(zeta),
                                  {.time_step = h, .rho_inf = rho, .tolerance = 1e-11});
        dynamics.start(kTiny * body.shape(k), 0.5 * omega * kTiny * body.shape(k));
        // The first acceleration, from the effective mass (1 - am) + ... = (1 - am) / beta h^2 ...
        ScalarMotion known{omega, zeta, h, rho, kTiny, 0.5 * omega * kTiny};
        const double am = (2 * rho - 1) / (rho + 1), af = rho / (rho + 1);
        const double gamma = 0.5 - am + af, beta = std::pow(1 - am + af, 2) / 4;
        const double mass = (1 - am) / (beta * h * h);
        known.a =
            -mass * (omega * omega * known.q + 2 * zeta * omega * known.v) /
            (mass + (1 - af) * gamma / (beta * h) * 2 * zeta * omega + (1 - af) * omega * omega);
        double worst = 0, others = 0;
        for (int n = 0; n < 120; ++n) {
          dynamics.step(body.nothing());
          known.step(0);
          const Matrix3Xd& u = dynamics.displacement();
          worst = std::max(worst, std::abs(body.amplitude(k, u) - known.q));
          others = std::max(others, (u - known.q * body.shape(k)).norm() / body.shape(k).norm());
        }
        CHECK(worst / kTiny <= tolerance(1e-6, "rounding; the square of the slope"));
        CHECK(others / kTiny <= tolerance(3e-4, "the slope, and rounding"));
      }
    }
  }
}

TEST_CASE("a cantilever that is let go swings with the period of its mode", "[solid][dynamics]") {
  const Cantilever body;
  const double omega = body.modes.omega[0];
  for (const int steps : {20, 40}) {
    const double h = 2 * std::numbers::pi / omega / steps;
    // Without loss the method turns by 2 atan(omega h / 2) a step, exactly.
    const double period = std::numbers::pi / std::atan(0.5 * omega * h) * h;
    ImplicitDynamics dynamics(body.model, kDensity, {},
                              {.time_step = h, .rho_inf = 1, .tolerance = 1e-11});
    dynamics.start(kTiny * body.shape(0), body.nothing());
    for (int n = 0; n < 5 * steps; ++n) dynamics.step(body.nothing());
    const double q = body.amplitude(0, dynamics.displacement()) / kTiny;
    const double p = body.amplitude(0, dynamics.velocity()) / kTiny /
                     (2 / h * std::tan(std::atan(omega * h / 2)));
    const double angle = std::atan2(-p, q);  // from a whole number of periods, too late: negative
    const double expected =
        2 * std::numbers::pi * (dynamics.time() / period - 5);  // about -5 (omega h)^2 / 12 turns
    CHECK(std::abs(angle - expected) <= tolerance(1e-6, "rounding of the forces"));
    CHECK(-expected / (2 * std::numbers::pi * 5) ==
          Approx(std::pow(omega * h, 2) / 12).epsilon(0.05));
  }
}

// (q at time t) of an oscillator that is let go at q = 1 from rest.
double ringing(double omega, double zeta, double t) {
  const double damped = omega * std::sqrt(1 - zeta * zeta);
  return std::exp(-zeta * omega * t) *
         (std::cos(damped * t) + zeta * omega / damped * std::sin(damped * t));
}

TEST_CASE("a damped mode decays as exp(-zeta omega t), of second order in the time step",
          "[solid][dynamics]") {
  constexpr double kZeta = 0.075;
  const Cantilever body;
  for (const Index k : {0, 4}) {
    const double omega = body.modes.omega[k];
    const double period = 2 * std::numbers::pi / omega;
    std::array<double, 3> errors{};
    std::size_t row = 0;
    for (const int steps : {40, 80, 160}) {
      const double h = period / steps;
      ImplicitDynamics dynamics(body.model, kDensity, body.damping(kZeta),
                                {.time_step = h, .tolerance = 1e-10});
      dynamics.start(kTiny * body.shape(k), body.nothing());
      for (int n = 0; n < 3 * steps; ++n) {
        dynamics.step(body.nothing());
        const double q = body.amplitude(k, dynamics.displacement()) / kTiny;
        errors[row] = std::max(errors[row], std::abs(q - ringing(omega, kZeta, dynamics.time())));
      }
      ++row;
    }
    INFO("mode " << k << ": errors " << errors[0] << " " << errors[1] << " " << errors[2]);
    CHECK(errors[2] <=
          tolerance(1e-3, "phase: 0.088 (omega h)^2 2 pi a period, of which damping leaves one"));
    CHECK(errors[0] / errors[1] == Approx(4).margin(tolerance(0.05, "terms of higher order")));
    CHECK(errors[1] / errors[2] == Approx(4).margin(tolerance(0.05, "terms of higher order")));
  }
}

TEST_CASE("a load that comes and goes at once keeps the second order", "[solid][dynamics]") {
  const Cantilever body;
  const double omega = body.modes.omega[0];
  const double period = 2 * std::numbers::pi / omega;
  const Matrix3Xd load = kTiny * omega * omega * (body.shape(0) * body.M);
  // q = 1 - cos(omega t) while it acts, free motion after 0.4 periods.
  const double until = 0.4 * period, end = 0.8 * period;
  const double q = 1 - std::cos(omega * until), p = std::sin(omega * until);
  const double exact = q * std::cos(omega * (end - until)) + p * std::sin(omega * (end - until));
  std::array<double, 3> errors{};
  std::size_t row = 0;
  for (const int steps : {20, 40, 80}) {
    ImplicitDynamics dynamics(body.model, kDensity, {},
                              {.time_step = period / steps, .tolerance = 1e-10});
    for (int n = 0; n < steps * 4 / 5; ++n) {
      dynamics.step(n < steps * 2 / 5 ? load : body.nothing());
    }
    errors[row++] = std::abs(body.amplitude(0, dynamics.displacement()) / kTiny - exact);
  }
  INFO("errors " << errors[0] << " " << errors[1] << " " << errors[2]);
  CHECK(errors[0] / errors[1] == Approx(4).margin(tolerance(0.05, "terms of higher order")));
  CHECK(errors[1] / errors[2] == Approx(4).margin(tolerance(0.05, "terms of higher order")));
}

TEST_CASE("large swings are of second order too", "[solid][dynamics]") {
  const Cantilever body("neo-hookean");
  const double period = 2 * std::numbers::pi / body.modes.omega[0];
  // Starts in the first shape, with a tip that moves by a fifth of the length.
  const double size = 0.04 / body.shape(0).cwiseAbs().maxCoeff();
  const auto state_after = [&](int steps) {
    ImplicitDynamics dynamics(body.model, kDensity, body.damping(0.075),
                              {.time_step = period / steps, .tolerance = 1e-10});
    dynamics.start(body.nothing(), size * body.modes.omega[0] * body.shape(0));
    for (int n = 0; n < steps * 3 / 4; ++n) dynamics.step(body.nothing());
    return Matrix3Xd(dynamics.displacement());
  };
  const Matrix3Xd a = state_after(200), b = state_after(400), c = state_after(800),
                  d = state_after(1600);
  const double first = (a - b).norm(), second = (b - c).norm(), third = (c - d).norm();
  INFO("changes " << first << " " << second << " " << third << " of " << d.norm());
  CHECK(second / third == Approx(4).margin(tolerance(0.05, "terms of higher order")));
  CHECK(third <= 1e-3 * d.norm());
}

TEST_CASE("the energy is that of the start and of the loads, less what damping takes",
          "[solid][dynamics]") {
  const Cantilever body;
  const double h = 2 * std::numbers::pi / body.modes.omega[0] / 50;
  const Matrix3Xd load = body.at_tip({0, 1e-6, 2e-6});
  for (const double zeta : {0.0, 0.1}) {
    for (const double rho : {1.0, 0.8}) {
      INFO("zeta " << zeta << ", rho_inf " << rho);
      ImplicitDynamics dynamics(body.model, kDensity, body.damping(zeta),
                                {.time_step = h, .rho_inf = rho, .tolerance = 1e-11});
      dynamics.start(kTiny * body.shape(1), body.nothing());
      const double begin = dynamics.energy().balance();
      double largest = begin, highest = 0, lowest = 0;
      for (int n = 0; n < 150; ++n) {
        dynamics.step(n % 50 < 20 ? load : body.nothing());
        const DynamicEnergy& energy = dynamics.energy();
        largest = std::max({largest, energy.kinetic, energy.elastic});
        highest = std::max(highest, energy.balance() - begin);
        lowest = std::min(lowest, energy.balance() - begin);
      }
      const DynamicEnergy& energy = dynamics.energy();
      CHECK(std::abs(energy.work) > 0.05 * largest);
      CHECK((zeta > 0 ? energy.dissipated > 0.05 * largest : energy.dissipated == 0));
      // The jumps of the load start motion that 50 steps in a period of the slowest mode do not
      // follow. Below rho_inf = 1 the method takes its energy.
      if (rho == 1.0) {
        CHECK(highest / largest <= tolerance(5e-6, "exact when linear; slopes of 4e-5"));
        CHECK(-lowest / largest <= tolerance(5e-6, "as above"));
      } else {
        CHECK(highest / largest <= tolerance(1e-3, "du is h times the weighted v to h^2"));
        CHECK(-lowest / largest <= tolerance(5e-3, "what rho_inf takes of fast motion"));
        if (zeta == 0) CHECK(highest == 0);
      }
    }
  }
}

TEST_CASE("the drift of a large swing's energy falls with the square of the step",
          "[solid][dynamics]") {
  const Cantilever body("neo-hookean");
  const double period = 2 * std::numbers::pi / body.modes.omega[0];
  const double size = 0.04 / body.shape(0).cwiseAbs().maxCoeff();
  const auto drift = [&](int steps) {
    ImplicitDynamics dynamics(body.model, kDensity, {},
                              {.time_step = period / steps, .rho_inf = 1, .tolerance = 1e-10});
    dynamics.start(body.nothing(), size * body.modes.omega[0] * body.shape(0));
    const double begin = dynamics.energy().balance();
    double most = 0;
    for (int n = 0; n < steps; ++n) {
      dynamics.step(body.nothing());
      most = std::max(most, std::abs(dynamics.energy().balance() - begin));
    }
    return most / begin;
  };
  const double coarse = drift(300), fine = drift(600);
  INFO("drifts " << coarse << " " << fine);
  CHECK(fine <= tolerance(1e-5, "(omega h)^2 / 12 = 1e-5 of a nonlinear share that is below 1"));
  CHECK(coarse / fine == Approx(4).margin(tolerance(0.4, "stiffer motion of fewer steps")));
}

TEST_CASE("under a load that stays, a body that is damped comes to its equilibrium",
          "[solid][dynamics]") {
  // With weight as a preload, one side held across only, and 4-node elements.
  SolidModel model = test::standing_rubber(box_tets({0, 0, 0}, {0.02, 0.03, 0.06}, 2, 3, 6));
  for (const int n : nodes_on_plane(model.mesh, {0, 0, 0}, {1, 0, 0}, 1e-9)) {
    if (model.mesh.nodes(2, n) > 1e-6) model.supports.push_back({n, {true, false, false}});
  }
  const EquilibriumSolver solver(model);
  Matrix3Xd weight = Matrix3Xd::Zero(3, model.mesh.node_count());
  weight.row(2).setConstant(-0.02);
  const PathResult rest = solver.solve_path(weight, std::array{1.0});
  REQUIRE(rest.complete);
  const Preloaded preloaded{weight, rest.steps[0].displacement};
  Matrix3Xd load = Matrix3Xd::Zero(3, model.mesh.node_count());
  for (const int n : nodes_on_plane(model.mesh, {0, 0, 0.06}, {0, 0, 1}, 1e-9)) load(1, n) = 0.01;
  const PathResult pressed = solver.solve_path(load, std::array{1.0}, {.preloaded = &preloaded});
  REQUIRE(pressed.complete);
  const VibrationModes modes =
      vibration_modes(LoadResponse(model, &preloaded), kDensity, {.least = 8, .below = 0});
  ImplicitDynamics dynamics(model, kDensity, {modes.omega, modes.shapes, 0.7},
                            {.time_step = 1 / modes.omega[0]}, &preloaded);
  // At rest nothing moves.
  for (int n = 0; n < 3; ++n) dynamics.step(Matrix3Xd::Zero(3, model.mesh.node_count()));
  const double moved = (pressed.steps[0].displacement - preloaded.rest).norm();
  CHECK((dynamics.displacement() - preloaded.rest).norm() / moved <=
        tolerance(1e-5, "the equilibrium's tolerance"));
  for (int n = 0; n < 60; ++n) dynamics.step(load);
  CHECK((dynamics.displacement() - pressed.steps[0].displacement).norm() / moved <=
        tolerance(1e-6, "exp(-0.7 60), and the tolerances of both"));
  CHECK(dynamics.energy().kinetic <= 1e-8 * dynamics.energy().elastic);
  for (const Support& support : model.supports) {
    CHECK(dynamics.displacement()(0, support.node) == 0);
  }
}

TEST_CASE("a part that has turned is damped as one that has not", "[solid][dynamics]") {
  const Cantilever body("neo-hookean");
  constexpr double kZeta = 0.02;
  const double period = 2 * std::numbers::pi / body.modes.omega[0];
  // The tip swings by a fifth of the length: it turns by 17 degrees.
  const double size = 0.04 / body.shape(0).cwiseAbs().maxCoeff();
  ImplicitDynamics dynamics(body.model, kDensity, body.damping(kZeta),
                            {.time_step = period / 200, .rho_inf = 1});
  dynamics.start(body.nothing(), size * body.modes.omega[0] * body.shape(0));
  const double begin = dynamics.energy().balance();
  for (int n = 0; n < 200; ++n) dynamics.step(body.nothing());
  const double lost = dynamics.energy().dissipated / begin;
  const double expected = 1 - std::exp(-4 * std::numbers::pi * kZeta);
  INFO("lost " << lost << ", expected " << expected);
  CHECK(lost == Approx(expected).epsilon(tolerance(0.1, "the square of the turning")));
}

TEST_CASE("a bar that is struck at its end pushes back with rho c A V", "[solid][dynamics]") {
  // Along X, of nu = 0, held at its far end: a wave of the speed c = sqrt(E / rho) leaves the end
  // that a plate pushes with the speed V, and behind it the stress is rho c V.
  constexpr double kLength = 0.2, kSide = 0.01, kYoung = 1e6, kSpeed = 0.02;
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {kLength, kSide, kSide}, 40, 2, 2);
  model.material = material_from_young("saint-venant-kirchhoff", kYoung, 0.0);
  model.fixed_nodes = nodes_on_plane(model.mesh, {kLength, 0, 0}, {1, 0, 0}, 1e-9);
  const double c = std::sqrt(kYoung / kDensity), force = kDensity * c * kSide * kSide * kSpeed;
  const double way = kLength / c;  // s
  const double h = way / 80;
  ImplicitDynamics dynamics(model, kDensity, {}, {.time_step = h, .rho_inf = 0.5});
  dynamics.set_obstacle([&](double t) {
    return Obstacle{.half_spaces = {{{kSpeed * t, 0, 0}, {1, 0, 0}}}};
  });
  const Matrix3Xd nothing = Matrix3Xd::Zero(3, model.mesh.node_count());
  double impulse = 0, first = 0, second = 0, work = 0;
  for (int n = 0; n < 280; ++n) {
    dynamics.step(nothing);
    const double push = dynamics.contact_force()[0];
    CHECK(push >= 0);
    if (n == 0) CHECK(push > 0);  // the pose is that of the end of the step
    impulse += push * h;
    work += push * kSpeed * h;
    if (n >= 40 && n < 140) first += push / 100;
    if (n >= 180 && n < 260) second += push / 80;
  }
  // Until the wave is back it is rho c A V; then three times that, as the speed is imposed.
  INFO("forces " << first / force << " " << second / force << ", touching " << dynamics.touching());
  CHECK(first == Approx(force).epsilon(tolerance(0.02, "spread of the front over some elements")));
  CHECK(second == Approx(3 * force).epsilon(tolerance(0.02, "as above")));
  // What the plate has done is in the bar, or lost by the method: the front's steps.
  CHECK(dynamics.energy().work == Approx(work).epsilon(tolerance(0.03, "the first touch")));
  CHECK(dynamics.energy().balance() <= work * tolerance(1e-3, "the solves"));
  CHECK(dynamics.energy().balance() >= -work * tolerance(0.05, "loss at the front"));
  CHECK(impulse > 0);
}

TEST_CASE("an obstacle that stays is borne as in a static contact", "[solid][dynamics]") {
  const SolidModel model =
      test::standing_rubber(box_tets({-0.02, -0.02, 0}, {0.02, 0.02, 0.03}, 5, 5, 4));
  constexpr double kRadius = 0.015, kDepth = 0.003;
  const auto pressing = [&](double depth) {
    return Obstacle{.capsules = {ball({0.001, 0.002, 0.03 + kRadius - depth}, kRadius)}};
  };
  const EquilibriumSolver solver(model);
  ContactWalk walk(solver, [&](double t) { return pressing(t * kDepth); }, 0.0, {.spacing = 0.003});
  REQUIRE(walk.advance(1.0));
  const VibrationModes modes =
      vibration_modes(LoadResponse(model), kDensity, {.least = 8, .below = 0});
  const double h = 0.5 / modes.omega[0];
  ImplicitDynamics dynamics(model, kDensity, {modes.omega, modes.shapes, 0.7},
                            {.time_step = h, .rho_inf = 0.3});
  dynamics.set_obstacle([&](double t) { return pressing(kDepth * std::min(1.0, t / (10 * h))); },
                        {.spacing = 0.003});
  const Matrix3Xd nothing = Matrix3Xd::Zero(3, model.mesh.node_count());
  for (int n = 0; n < 80; ++n) dynamics.step(nothing);
  CHECK(dynamics.touching() == walk.now().touching);
  CHECK((dynamics.contact_force() - walk.now().force).norm() / walk.now().force.norm() <=
        tolerance(1e-3, "gaps of 1e-6 of the body's size in both, of a press of 0.06"));
  CHECK((dynamics.displacement() - walk.now().displacement).norm() /
            walk.now().displacement.norm() <=
        tolerance(1e-4, "the same gaps"));
  // A thing that is gone pushes no more, and the body comes back.
  dynamics.set_obstacle([](double) { return Obstacle{}; }, {.spacing = 0.003});
  for (int n = 0; n < 80; ++n) dynamics.step(nothing);
  CHECK(dynamics.contact_force().norm() == 0);
  CHECK(dynamics.displacement().norm() / walk.now().displacement.norm() <=
        tolerance(1e-5, "exp(-0.7 40)"));
  // A new start knows no obstacle.
  dynamics.set_obstacle([&](double) { return pressing(kDepth); }, {.spacing = 0.003});
  dynamics.start(nothing, nothing);
  dynamics.step(nothing);
  CHECK(dynamics.touching() == 0);
}

TEST_CASE("a state that is inverted is refused, and so are settings without meaning",
          "[solid][dynamics]") {
  const SolidModel model = test::standing_rubber(box_tets({0, 0, 0}, {0.02, 0.02, 0.02}, 1, 1, 1));
  ImplicitDynamics dynamics(model, kDensity, {});
  const Matrix3Xd nothing = Matrix3Xd::Zero(3, model.mesh.node_count());
  Matrix3Xd inverted = nothing;
  inverted.row(2) = -2 * model.mesh.nodes.row(2);
  CHECK_THROWS_AS(dynamics.start(inverted, nothing), Error);
  CHECK_THROWS_AS(ImplicitDynamics(model, kDensity, {}, {.time_step = 0}), ContractViolation);
  CHECK_THROWS_AS(ImplicitDynamics(model, kDensity, {}, {.rho_inf = 1.1}), ContractViolation);
  CHECK_THROWS_AS(ImplicitDynamics(model, kDensity, {.ratio = 0.1}), ContractViolation);
}

}  // namespace
}  // namespace palpable
