// Ticks: steps of a millisecond beside whole frames of the same length.

#include "palpable/common/base/order_statistics.h"
#include "palpable/common/response/touch_solver.h"
#include "tests/support/allocations.h"
#include "tests/support/ringing_sheet.h"
#include "tests/support/rubbing.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::RingingSheet;
using test::Rubbing;
using test::tolerance;

constexpr double kRadius = 0.02;  // m, of a ball
constexpr double kTick = 1e-3;    // s
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

TouchSettings settings_with(double mu, bool inertia) {
  TouchSettings settings = test::with_friction(mu);
  settings.inertia = inertia;
  return settings;
}

// A sheet with nonlinear terms that a ball presses, by frames or by ticks.
class Sheet {
 public:
  explicit Sheet(double mu, bool inertia) : body(0.1) {
    test::add_region_all_over(body.tables, 0.2f);
    solver.emplace(body.skin, body.fixed, body.tables, settings_with(mu, inertia));
  }
  const CapsuleObstacles& at(const Vector3d& lowest) {
    const Vector3d centre = lowest + Vector3d(0, 0, kRadius);
    return rubbing_.at({{centre, centre, kRadius, kRadius}});
  }
  void frame(const Vector3d& lowest) {
    report = solver->advance(state, at(lowest), kNoLimit, kTick);
  }
  void tick(const Vector3d& lowest) {
    const CapsuleObstacles& there = at(lowest);
    tick_report = solver->tick(state, there, kTick, static_cast<double>(there.largest_way()));
  }
  void replace_state() {
    solver->drop_ticks();
    state = TouchState();
    rubbing_ = Rubbing();
  }
  [[nodiscard]] Vector3d force() const {  // N
    Vector3d sum = Vector3d::Zero();
    for (const PointForce& at : state.forces) sum += at.force.cast<double>();
    return sum;
  }

 private:
  Rubbing rubbing_;

 public:
  RingingSheet body;
  std::optional<TouchSolver> solver;
  TouchState state;
  TouchReport report;
  ContactReport tick_report;
};

// A ball comes at 0.1 m/s, stays 4 mm deep, slides aside, and leaves as fast.
Vector3d lowest_at(int tick) {
  const double t = kTick * tick;
  const double depth = std::min({0.1 * t - 0.002, 0.004, 0.1 * (0.2 - t)});
  return {std::clamp(0.05 * (t - 0.08), 0.0, 0.003), 0, -depth};
}
constexpr int kTicks = 230;

TEST_CASE("ticks have the forces of frames of the same length", "[contact]") {
  for (const bool inertia : {true, false}) {
    for (const double mu : {0.0, 0.3}) {
      CAPTURE(inertia, mu);
      Sheet ticked(mu, inertia), framed(mu, inertia);
      double largest = 0;
      std::vector<double> apart;
      for (int k = 0; k < kTicks; ++k) {
        ticked.tick(lowest_at(k));
        framed.frame(lowest_at(k));
        largest = std::max(largest, framed.force().norm());
        apart.push_back((ticked.force() - framed.force()).norm());
      }
      CHECK(largest > 0.01);
      CHECK(percentile(apart, 0.8) <
            tolerance(3e-3, "nonlinear terms of up to 8 ms ago") * largest);
      CHECK(percentile(apart, 1.0) <
            tolerance(0.05, "one of the few points begins to rub a tick earlier") * largest);
      CHECK(ticked.state.forces.empty() == framed.state.forces.empty());
    }
  }
}

TEST_CASE("after ticks the displacement is that of the forces, and frames go on from there",
          "[contact]") {
  Sheet ticked(0.3, true), framed(0.3, true);
  for (int k = 0; k < 90; ++k) {
    ticked.tick(lowest_at(k));
    framed.frame(lowest_at(k));
  }
  const auto apart = [&] { return (ticked.state.u - framed.state.u).colwise().norm().maxCoeff(); };
  const float largest = framed.state.u.colwise().norm().maxCoeff();
  ticked.solver->end_ticks();
  CHECK(apart() < tolerance(0.02f, "as for the forces") * largest);
  for (int k = 90; k < 100; ++k) {
    const double before = ticked.force().norm();
    ticked.frame(lowest_at(k));
    framed.frame(lowest_at(k));
    CHECK(std::abs(ticked.force().norm() - before) <
          tolerance(0.05, "the issue's bar for jumps") * framed.force().norm());
    CHECK(ticked.report.reached() == Reached::kYes);
  }
  CHECK(apart() < tolerance(0.01f, "the rest of it rings off") * largest);
}

TEST_CASE("an obstacle that jumps in a tick gets a whole frame", "[contact]") {
  Sheet ticked(0.3, true), framed(0.3, true);
  ticked.frame({0, 0, 0.001});
  framed.frame({0, 0, 0.001});
  ticked.tick({0, 0, -0.003});
  framed.frame({0, 0, -0.003});
  CHECK(framed.report.steps > 1);
  CHECK(ticked.tick_report.steps == framed.report.steps);
  CHECK(ticked.state.u == framed.state.u);
}

TEST_CASE("ticks allocate nothing, and touched points are where they are now", "[contact]") {
  for (const bool inertia : {true, false}) {
    Sheet sheet(0.3, inertia);
    for (int k = 0; k < 40; ++k) sheet.frame(lowest_at(k));
    std::vector<Eigen::Vector3f> moved;
    moved.reserve(2 * TouchSolver::kMostPoints);
    for (int k = 40; k < 60; ++k) {
      const CapsuleObstacles& there = sheet.at(lowest_at(k));
      const auto way = static_cast<double>(there.largest_way());
      CHECK(test::allocations_during([&] {
              sheet.solver->tick(sheet.state, there, kTick, way);
              sheet.solver->find_moved(sheet.state, moved);
            }) == 0);
    }
    std::vector<Eigen::Vector3f> after;
    sheet.solver->end_ticks();
    sheet.solver->find_moved(sheet.state, after);
    REQUIRE(after.size() == moved.size());
    REQUIRE(!moved.empty());
    for (std::size_t k = 0; k < moved.size(); ++k) {
      CHECK((moved[k] - after[k]).norm() < tolerance(1e-6f, "m, rounding of the tables"));
    }
  }
}

TEST_CASE("ticks of another state begin with that", "[contact]") {
  Sheet one(0.3, true), other(0.3, true);
  for (int k = 0; k < 60; ++k) one.tick(lowest_at(k));
  one.replace_state();
  for (int k = 0; k < 60; ++k) {
    one.tick(lowest_at(k));
    other.tick(lowest_at(k));
  }
  CHECK(one.force() == other.force());
  CHECK(one.force().norm() > 0);
}

}  // namespace
}  // namespace palpable
