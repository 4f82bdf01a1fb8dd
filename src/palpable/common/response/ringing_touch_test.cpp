// Inertia in contact: a sheet with mass that balls press, hit and let go.

#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/response/touch_solver.h"
#include "tests/support/allocations.h"
#include "tests/support/ringing_sheet.h"
#include "tests/support/rubbing.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using Eigen::Vector3f;
using test::RingingSheet;
using test::Rubbing;
using test::tolerance;

constexpr double kRadius = 0.02;  // m, of a ball

TouchSettings settings_with(double mu) {
  TouchSettings settings = test::with_friction(mu);
  settings.softness = 1e-4;
  return settings;
}

// A sheet in its upper half-space by balls that move from frame to frame.
class Hit {
 public:
  explicit Hit(double loss_factor = 0.1, double mu = 0)
      : body(loss_factor), solver(body.skin, body.fixed, body.tables, settings_with(mu)) {}

  // A ball whose lowest point is there, m.
  void advance(const Vector3d& lowest, std::optional<double> time) {
    const Vector3d centre = lowest + Vector3d(0, 0, kRadius);
    report = solver.advance(state, rubbing_.at({{centre, centre, kRadius, kRadius}}), 1e9, time);
  }
  void let_go(std::optional<double> time) {
    report = solver.advance(state, rubbing_.at({}), 1e9, time);
  }

  [[nodiscard]] Vector3d force() const {  // N
    Vector3d sum = Vector3d::Zero();
    for (const PointForce& at : state.forces) sum += at.force.cast<double>();
    return sum;
  }
  [[nodiscard]] Vector3f middle() const { return state.u.col(body.middle()); }  // m

  // J: (f . R f + q'^2 + omega^2 q^2) / 2, with R the compliance without the modes.
  [[nodiscard]] double energy() const {
    const VibrationTable& table = *body.tables.vibration;
    Eigen::VectorXd f = Eigen::VectorXd::Zero(body.G.cols());
    for (const PointForce& at : state.forces) {
      const SkinPoint& point = solver.points()[static_cast<std::size_t>(at.point)];
      for (std::size_t k = 0; k < 3; ++k) {
        const double weight = static_cast<double>(point.weights[static_cast<int>(k)]);
        f.segment<3>(3 * point.corners[k]) += weight * at.force.cast<double>();
      }
    }
    double twice = f.dot(body.G * f);
    const Eigen::VectorXd p = table.shapes.cast<double>() * f;
    for (std::size_t k = 0; k < table.omega.size(); ++k) {
      const double omega = table.omega[k], at = p[static_cast<Eigen::Index>(k)];
      const double q = state.vibration.q[k];
      const double v = state.vibration.velocity[k];
      twice += v * v + omega * omega * q * q - at * at / (omega * omega);
    }
    return twice / 2;
  }

 private:
  Rubbing rubbing_;

 public:
  RingingSheet body;
  TouchSolver solver;
  TouchState state;
  TouchReport report;
};

// The displacement of the middle after a ball has gone, at multiples of 33 ms.
std::vector<Vector3f> ring(double step) {
  Hit hit;
  hit.advance({0, 0, -0.004}, std::nullopt);
  std::vector<Vector3f> seen;
  const int each = static_cast<int>(std::lround(0.033 / step));
  for (int k = 1; k <= 10 * each; ++k) {
    hit.let_go(step);
    if (k % each == 0) seen.push_back(hit.middle());
  }
  return seen;
}

TEST_CASE("a sheet that is let go rings, the same in frames of any length", "[contact]") {
  const std::vector<Vector3f> long_frames = ring(0.033), short_frames = ring(0.0165),
                              shortest = ring(0.001);
  float largest = 0;
  for (const Vector3f& u : shortest) largest = std::max(largest, u.norm());
  CHECK(largest > 1e-4f);
  for (std::size_t k = 0; k < shortest.size(); ++k) {
    CHECK((long_frames[k] - shortest[k]).norm() < tolerance(1e-3f, "rounding") * largest);
    CHECK((short_frames[k] - shortest[k]).norm() < tolerance(1e-3f, "rounding") * largest);
  }
  // It overshoots to the other side of its rest.
  CHECK(std::any_of(shortest.begin(), shortest.end(), [](const auto& u) { return u.z() > 1e-4f; }));
}

TEST_CASE("a sheet that rang is at rest in the end, to the bit", "[contact]") {
  Hit hit(0.3);
  hit.advance({0, 0, -0.004}, 0.033);
  CHECK(hit.report.ringing > 0);
  double before = 1e9;
  int frames = 0;
  for (; hit.state.vibration.moves; ++frames) {
    REQUIRE(frames < 2000);
    hit.let_go(0.033);
    CHECK(hit.report.ringing <= before);
    before = hit.report.ringing;
  }
  CHECK(frames > 5);
  hit.let_go(0.033);
  CHECK(hit.state.u.isZero(0));
  CHECK(hit.solver.body().is_at_rest());
}

TEST_CASE("a slow press gives the static answer", "[contact]") {
  for (const double mu : {0.0, 0.3}) {
    Hit moving(0.3, mu), still(0.3, mu);
    constexpr double kFrame = 1.0 / 60, kSpeed = 0.001;
    double depth = -0.001;
    while (depth < 0.004) {
      depth += kSpeed * kFrame;
      moving.advance({0.0003, 0.0002, -depth}, kFrame);
      still.advance({0.0003, 0.0002, -depth}, std::nullopt);
    }
    const double apart =
        static_cast<double>((moving.state.u - still.state.u).colwise().norm().maxCoeff());
    CHECK(apart < tolerance(1e-3, "1 mm/s is 0.02 mm in a period") * 0.004);
    CHECK((moving.force() - still.force()).norm() <
          tolerance(5e-3, "contact points that begin to press") * still.force().norm());
  }
}

TEST_CASE("a press that stays ends in the static answer", "[contact]") {
  Hit moving(0.3), still(0.3);
  still.advance({0, 0, -0.003}, std::nullopt);
  for (int k = 0; k < 1200; ++k) moving.advance({0, 0, -0.003}, 1.0 / 60);  // 20 s
  const double apart =
      static_cast<double>((moving.state.u - still.state.u).colwise().norm().maxCoeff());
  CHECK(apart < tolerance(1e-4, "softness is a share of another mean compliance") * 0.003);
  CHECK(moving.report.ringing < 1e-12);
}

TEST_CASE("a thing gives a sheet no more energy than the work it does", "[contact]") {
  for (const double mu : {0.0, 0.4}) {
    Hit hit(0.0, mu);
    std::mt19937 random(4);
    std::normal_distribution<double> push(0, 1);
    const double h = 1.0 / 500;  // s, one step
    REQUIRE(hit.solver.body().steps_in(h) == 1);
    Vector3d at(0, 0, 0.001), velocity(0, 0, -0.1);
    hit.advance(at, h);
    double energy = hit.energy(), scale = 0, worst = 0;
    for (int k = 0; k < 600; ++k) {
      velocity += h * (-4000 * at + 20 * Vector3d(push(random), push(random), push(random)));
      velocity *= 0.98;
      const Vector3d way = h * velocity;
      at += way;
      hit.advance(at, h);
      const double now = hit.energy(), work = -hit.force().dot(-way);
      scale = std::max(scale, now);
      worst = std::max(worst, now - energy - work);
      energy = now;
    }
    CHECK(scale > 1e-4);
    CHECK(worst <
          tolerance(0.005, "normals turn within a step, iterations end at 0.02 mm") * scale);
  }
}

TEST_CASE("a hit: its force in steps of different length, and in frames that are divided",
          "[contact]") {
  constexpr double kSpeed = 0.2;  // m/s
  // The first peak of the force, and the force after 33 ms, N.
  const auto hit_in = [](double frame) {
    Hit hit;
    hit.advance({0, 0, 0.0005}, frame);
    double peak = 0, at_end = 0;
    for (int k = 1; k <= static_cast<int>(std::lround(0.033 / frame)); ++k) {
      const double t = k * frame;
      hit.advance({0, 0, 0.0005 - kSpeed * t}, frame);
      at_end = hit.force().norm();
      if (t < 0.02) peak = std::max(peak, at_end);
    }
    return std::pair(peak, at_end);
  };
  const double peak = hit_in(0.0002).first;
  CHECK(hit_in(0.001).first == Approx(peak).epsilon(tolerance(
                                   0.08, "forces of a step are those at its end: first order")));
  CHECK(hit_in(0.002).first == Approx(peak).epsilon(tolerance(0.16, "twice the step")));

  Hit divided;
  divided.advance({0, 0, 0.0005}, 0.033);
  divided.advance({0, 0, 0.0005 - kSpeed * 0.033}, 0.033);
  const int steps = divided.solver.body().steps_in(0.033);
  CHECK(divided.report.steps == steps);
  CHECK(divided.force().norm() ==
        Approx(hit_in(0.033 / steps).second)
            .epsilon(tolerance(0.01, "iterations of a step end at 0.02 mm")));
}

TEST_CASE("after a pause a body has rung on, and what presses it is where it is", "[contact]") {
  Hit hit(0.3), still(0.3);
  hit.advance({0, 0, -0.004}, std::nullopt);
  hit.let_go(0.01);
  const double energy = hit.report.ringing;
  REQUIRE(energy > 0);
  hit.let_go(0.3);
  CHECK(hit.report.ringing < 0.1 * energy);
  CHECK(hit.report.ringing > 0);
  hit.advance({0, 0, -0.003}, 60.0);  // came unseen: no velocity
  still.advance({0, 0, -0.003}, std::nullopt);
  CHECK((hit.state.u - still.state.u).norm() < tolerance(1e-3f, "softness") * still.state.u.norm());
}

// A sheet with inertia and nonlinear terms, which a ball presses.
struct BentSheet {
  explicit BentSheet(bool is_nonlinear = true) {
    if (is_nonlinear) test::add_region_all_over(body.tables, 0.2f);
    solver.emplace(body.skin, body.fixed, body.tables, settings_with(0));
  }
  void advance(double depth, std::optional<double> time) {
    const Vector3d centre(0.0003, 0.0002, kRadius - depth);
    solver->advance(state, rubbing.at({{centre, centre, kRadius, kRadius}}), 1e9, time);
  }

  RingingSheet body{0.3};
  std::optional<TouchSolver> solver;
  TouchState state;
  Rubbing rubbing;
};

// m
double apart(const BentSheet& a, const BentSheet& b) {
  return static_cast<double>((a.state.u - b.state.u).colwise().norm().maxCoeff());
}

TEST_CASE("nonlinear terms of a body with inertia end as those of the static one", "[contact]") {
  constexpr double kDepth = 0.004, kFrame = 1.0 / 60;
  BentSheet moving, still, linear(false);
  still.advance(kDepth, std::nullopt);
  linear.advance(kDepth, std::nullopt);
  REQUIRE(apart(still, linear) > 0.01 * kDepth);  // else nothing is shown by what follows
  moving.advance(0, 0.0);
  for (int k = 0; k < 1200; ++k) moving.advance(std::min(kDepth, 1e-4 * k), kFrame);
  CHECK(apart(moving, still) < tolerance(1e-3, "softness, contact points at their edge") * kDepth);
  // Let go, it is at rest in the end, to the bit.
  for (int k = 0; k < 1200; ++k) moving.advance(-0.05, kFrame);
  CHECK(moving.state.u.isZero(0));
  CHECK(moving.state.vibration.followed.empty());
}

TEST_CASE("after a pause nonlinear terms are those of the present loads", "[contact]") {
  BentSheet moving, still;
  moving.advance(0, 0.0);
  for (int k = 0; k < 30; ++k) moving.advance(1e-4 * k, 1.0 / 60);
  moving.advance(-0.05, 100.0);
  CHECK(moving.state.u.norm() < tolerance(1e-9f, "m: what rings after 100 s"));
  moving.advance(0.003, 100.0);
  still.advance(0.003, std::nullopt);
  CHECK(apart(moving, still) < tolerance(1e-3, "softness") * 0.003);
}

TEST_CASE("frames with inertia and nonlinear terms allocate nothing", "[contact]") {
  BentSheet sheet;
  for (int k = 0; k < 3; ++k) sheet.advance(0.001 * k, 0.033);
  const Vector3d centre(0.0003, 0.0002, kRadius - 0.003);
  const CapsuleObstacles& there = sheet.rubbing.at({{centre, centre, kRadius, kRadius}});
  CHECK(test::allocations_during([&] { sheet.solver->advance(sheet.state, there, 1e9, 0.033); }) ==
        0);
}

TEST_CASE("what comes fast from outside the body's box hits it in short steps", "[contact]") {
  Hit hit;
  hit.advance({0, 0, 0.03}, 0.033);  // farther away than the band
  hit.advance({0, 0, -0.003}, 0.033);
  CHECK(hit.report.steps >= static_cast<int>(0.033 / TouchSettings().largest_step));
  CHECK(hit.force().z() < 0);
}

TEST_CASE("what enters by no motion gives no velocity", "[contact]") {
  Hit hit(0.0);
  hit.advance({0, 0, 0.001}, 0.033);
  // It was never seen to move: the ball of the frame before is gone.
  hit.let_go(0.033);
  hit.advance({0, 0, -0.003}, 0.033);
  CHECK(hit.force().z() < 0);
  CHECK(hit.report.ringing < tolerance(1e-4, "of the static energy") * hit.energy());
}

TEST_CASE("a small jump of what presses gives no velocity either, inwards and outwards",
          "[contact]") {
  for (const double jump : {-2e-4, 2e-4}) {
    Hit hit(0.0);
    hit.advance({0, 0, -0.003}, 0.0);
    REQUIRE(hit.report.ringing == 0);
    hit.let_go(0.0);  // its place before is forgotten, as where a measurement corrects it
    hit.advance({0, 0, -0.003}, 0.0);
    const double at_rest = hit.energy();
    // The same ball, 0.2 mm elsewhere, of which no motion is known.
    Rubbing unknown;
    const Vector3d centre(0, 0, kRadius - 0.003 + jump);
    const TouchReport report =
        hit.solver.advance(hit.state, unknown.at({{centre, centre, kRadius, kRadius}}), 1e9, 0.033);
    CHECK(report.ringing < tolerance(1e-4, "of the static energy") * at_rest);
  }
}

TEST_CASE("frames with inertia allocate nothing and are pure", "[contact]") {
  for (const double mu : {0.0, 0.3}) {
    Hit one(0.1, mu), other(0.1, mu);
    for (int k = 0; k < 3; ++k) {
      one.advance({0.001, 0, 0.001 - 0.002 * k}, 0.033);
      other.advance({0.001, 0, 0.001 - 0.002 * k}, 0.033);
    }
    Rubbing rubbing;
    CHECK(one.state.u == other.state.u);
    CHECK(one.state.vibration.q == other.state.vibration.q);
    const Vector3d centre(0.001, 0, kRadius - 0.003);
    const CapsuleObstacles* obstacles = &rubbing.at({{centre, centre, kRadius, kRadius}});
    const auto allocations = test::allocations_during(
        [&] { one.report = one.solver.advance(one.state, *obstacles, 1e9, 0.033); });
    CHECK(allocations == 0);
    CHECK(one.report.ringing > 0);
  }
}

}  // namespace
}  // namespace palpable
