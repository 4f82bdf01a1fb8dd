#include "palpable/common/response/inertia.h"

#include "tests/support/ringing_sheet.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3f;
using test::tolerance;

constexpr int kNodes = 7;

// q and q' of one mode after a time under a constant force, by many steps of a Runge-Kutta method.
struct Oscillator {
  double omega, zeta, force, q, velocity;
  void advance(double time) {
    constexpr int kSteps = 2000;
    const double h = time / kSteps;
    const auto rate = [this](double x, double v) {
      return force - 2 * zeta * omega * v - omega * omega * x;
    };
    for (int k = 0; k < kSteps; ++k) {
      const double v1 = velocity, a1 = rate(q, velocity);
      const double v2 = velocity + h / 2 * a1, a2 = rate(q + h / 2 * v1, v2);
      const double v3 = velocity + h / 2 * a2, a3 = rate(q + h / 2 * v2, v3);
      const double v4 = velocity + h * a3, a4 = rate(q + h * v3, v4);
      q += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
      velocity += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
  }
};

TEST_CASE("modes follow a damped oscillator exactly under a constant force", "[response]") {
  const VibrationTable table = test::some_vibration(kNodes);
  Inertia inertia(table, kNodes);
  const std::vector<VertexForce> loads{{2, Vector3f(0.3f, -0.1f, 0.7f)}, {5, Vector3f(0, 0.2f, 0)}};
  for (const double h : {0.002, 0.033}) {
    VibrationState state;
    inertia.rest(state, {});
    state.moves = true;
    for (std::size_t k = 0; k < state.q.size(); ++k) {
      state.q[k] = 0.01 * static_cast<double>(k + 1);
      state.velocity[k] = 0.3 - 0.1 * static_cast<double>(k);
    }
    const VibrationState began = state;
    inertia.set_step(h);
    inertia.begin_step(state, loads);
    inertia.load(loads);
    inertia.end_step(state, false);
    for (std::size_t k = 0; k < state.q.size(); ++k) {
      Oscillator exact{table.omega[k], table.damping(), state.force[k], began.q[k],
                       began.velocity[k]};
      exact.advance(h);
      CHECK(state.q[k] == Approx(exact.q).margin(tolerance(1e-9, "of the Runge-Kutta method")));
      CHECK(state.velocity[k] ==
            Approx(exact.velocity).margin(tolerance(1e-7, "of the Runge-Kutta method")));
    }
  }
}

TEST_CASE("a step without time keeps velocity and lag, and takes up the new forces", "[response]") {
  const VibrationTable table = test::some_vibration(kNodes);
  Inertia inertia(table, kNodes);
  const std::vector<VertexForce> before{{1, Vector3f(0, 0, 1)}}, after{{4, Vector3f(2, 0, 0)}};
  VibrationState state;
  inertia.set_step(0.004);
  inertia.begin_step(state, before);
  inertia.load(after);  // so that it moves
  inertia.end_step(state, false);
  const VibrationState began = state;
  const Eigen::Matrix3Xf lag = inertia.field(state);
  REQUIRE(lag.norm() > 1e-6f);
  inertia.set_step(0);
  inertia.begin_step(state, after);
  inertia.load(before);
  inertia.end_step(state, false);
  CHECK(state.velocity == began.velocity);
  CHECK((inertia.field(state) - lag).norm() < tolerance(1e-6f, "rounding") * lag.norm());
  CHECK(state.q != began.q);
}

TEST_CASE("a body at rest under forces stays at rest in a step with time", "[response]") {
  Inertia inertia(test::some_vibration(kNodes), kNodes);
  const std::vector<VertexForce> loads{{3, Vector3f(0.2f, 0.5f, -1)}};
  VibrationState state;
  inertia.rest(state, loads);
  inertia.set_step(0.002);
  for (int k = 0; k < 100; ++k) {
    inertia.begin_step(state, loads);
    inertia.load(loads);
    inertia.end_step(state, false);
  }
  const double stored = 0.5 * 5 / 900.0;  // J, of order |p|^2 / omega^2
  CHECK(inertia.energy(state) < tolerance(1e-10, "rounding of r to single precision") * stored);
}

TEST_CASE("what no longer moves visibly comes to rest", "[response]") {
  const VibrationTable table = test::some_vibration(kNodes);
  Inertia inertia(table, kNodes);
  const std::vector<VertexForce> loads{{0, Vector3f(0, 0, 0.01f)}};
  VibrationState state;
  inertia.rest(state, loads);
  double before = 1e30;
  state.moves = true;  // under no force
  state.force.assign(state.force.size(), 0.0);
  inertia.set_step(1.0 / 60);
  int frames = 0;
  for (; state.moves; ++frames) {
    REQUIRE(frames < 2000);
    CHECK(inertia.amplitude(state) <= before * (1 + tolerance(0.08, "zeta: r and q'/omega")));
    before = inertia.amplitude(state);
    inertia.begin_step(state, {});
    inertia.end_step(state, true);
  }
  CHECK(before < 2e-7);
  // e^(-zeta omega t) from the first amplitude to 1e-7 m.
  CHECK(frames > 60);
}

TEST_CASE("modes above 125 Hz are static", "[response]") {
  VibrationTable table = test::some_vibration(kNodes);
  table.omega = {30, 40, 50, 800, 900};
  const Inertia inertia(table, kNodes);
  CHECK(inertia.mode_count() == 3);
  CHECK(inertia.steps_in(1) == static_cast<int>(std::ceil(8 * 50 / (2 * 3.14159265358979))));
  table.omega = {800, 900, 1000, 1100, 1200};
  CHECK(Inertia(table, kNodes).mode_count() == 0);
}

TEST_CASE("the compliance of a step is what a change of the loads changes", "[response]") {
  const VibrationTable table = test::some_vibration(kNodes);
  Inertia inertia(table, kNodes);
  inertia.set_step(0.003);
  inertia.begin_step({}, {});
  const std::vector<VertexForce> one{{2, Vector3f(0, 0.5f, 0.5f)}};
  inertia.load(one);
  const Vector3f moved = inertia.displacement_at(6);
  const std::size_t r = inertia.row_width();
  std::vector<float> at_two(r, 0), at_six(r, 0), turned(r);
  inertia.add_row(2, one[0].force, at_two);
  inertia.times(at_two, turned);
  for (int c = 0; c < 3; ++c) {
    std::fill(at_six.begin(), at_six.end(), 0.0f);
    inertia.add_row(6, Vector3f::Unit(c), at_six);
    float sum = 0;
    for (std::size_t k = 0; k < r; ++k) sum += at_six[k] * turned[k];
    CHECK(sum == Approx(moved[c]).epsilon(tolerance(1e-4, "single precision")));
  }
}

TEST_CASE("without the modes the compliance of a sheet is not negative", "[response]") {
  const test::RingingSheet sheet;
  const VibrationTable& table = *sheet.tables.vibration;
  const Eigen::MatrixXd Phi = table.shapes.cast<double>().transpose();
  Eigen::VectorXd inverse(table.mode_count());
  for (int k = 0; k < table.mode_count(); ++k) {
    inverse[k] =
        1 / (table.omega[static_cast<std::size_t>(k)] * table.omega[static_cast<std::size_t>(k)]);
  }
  const Eigen::MatrixXd left = sheet.G - Phi * inverse.asDiagonal() * Phi.transpose();
  const Eigen::VectorXd random = Eigen::VectorXd::LinSpaced(left.rows(), -1, 1).array().sin();
  CHECK(random.dot(left * random) > 0);
  CHECK(left.norm() < 0.9 * sheet.G.norm());
}

}  // namespace
}  // namespace palpable
