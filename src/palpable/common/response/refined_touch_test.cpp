#include "palpable/common/response/refinement.h"
#include "palpable/common/response/touch_solver.h"
#include "tests/support/allocations.h"
#include "tests/support/ball_gap.h"
#include "tests/support/elastic_sheet.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;
using test::ElasticSheet;
using test::tolerance;

constexpr float kRadius = 0.02f;

test::GapFunction ball(float depth, float x = 0) {
  return test::gap_to_ball(Vector3f(x, 0, kRadius - depth), kRadius);
}

double apart(const Matrix3Xf& a, const Matrix3Xf& b) {
  return static_cast<double>((a - b).colwise().norm().maxCoeff());
}

// A sheet with linear tables whose full-order solution is larger by an eighth: (1 + kSofter) G f.
struct Sheet {
  static constexpr float kSofter = 0.125f;
  ElasticSheet body;
  TouchSettings settings;
  TouchState state;
  RequestedLoad load;
  Sheet() { settings.softness = 1e-6; }
  [[nodiscard]] TouchSolver solver() const {
    return {body.skin, body.fixed, body.tables, settings};
  }
  [[nodiscard]] Matrix3Xf exact() const { return (1 + kSofter) * load.tables; }
  // Presses with a ball, then takes up full-order solutions, each until it is blended in.
  void refine(TouchSolver& solver, const test::GapFunction& gap, int times = 1) {
    solver.advance(state, gap);
    for (int k = 0; k < times; ++k) {
      REQUIRE(solver.request(state, load));
      REQUIRE(solver.refine(state, load, exact()));
      for (int frame = 0; frame < settings.blend_frames; ++frame) solver.advance(state, gap);
    }
  }
  [[nodiscard]] double force() const {
    double sum = 0;
    for (const PointForce& f : state.forces) sum += static_cast<double>(f.force.norm());
    return sum;
  }
};

TEST_CASE("a correction holds for loads like its own", "[contact][law]") {
  CHECK(correction_weight(3, 3, 3) == 1.0f);
  CHECK(correction_weight(0, 0, 3) == 0.0f);
  // The same load, 0.6 times as large.
  CHECK(correction_weight(0.36f * 3, 0.6f * 3, 3) == Approx(0.36));
  // No correction under the opposite load, nor if the solved load was 0.
  CHECK(correction_weight(3, -3, 3) == 0.0f);
  CHECK(correction_weight(3, 3, 0) == 0.0f);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(correction_weight(nan, 1, 1) == 0.0f);
  CHECK(correction_weight(1, nan, 1) == 0.0f);
  // The same load with another one as large whose points do not displace each other.
  CHECK(correction_weight(6, 3, 3) == Approx(1.0 / 16));
  // The weight is bounded for larger loads.
  CHECK(correction_weight(9 * 3, 3 * 3, 3) == correction_weight(4 * 3, 2 * 3, 3));
  // The weight rises with similarity, and is at most 1 for a load that is not larger.
  for (float shared = 0; shared < 3; shared += 0.1f) {
    CHECK(correction_weight(3, shared, 3) <= correction_weight(3, shared + 0.1f, 3));
    CHECK(correction_weight(3, shared, 3) <= 1.0f);
  }
}

TEST_CASE("with full-order solutions contact becomes that of the full-order body", "[contact]") {
  Sheet sheet;
  TouchSolver solver = sheet.solver();
  const test::GapFunction gap = ball(0.003f);
  const double before = 1 / (1 + static_cast<double>(Sheet::kSofter));
  solver.advance(sheet.state, gap);
  const double by_tables = sheet.force();
  const Matrix3Xf shape = sheet.state.u;
  sheet.refine(solver, gap, 4);
  // A body that is softer everywhere takes the same shape under a smaller force.
  CHECK(sheet.force() / by_tables == Approx(before).margin(tolerance(0.002, "four answers")));
  CHECK(apart(sheet.state.u, shape) < tolerance(4e-5, "m: twice the last step's"));
  REQUIRE(solver.request(sheet.state, sheet.load));
  CHECK(apart(sheet.state.u, sheet.exact()) <
        tolerance(1e-5, "m: the state carries the load of the full-order solution"));
}

TEST_CASE("a full-order solution is blended in frame by frame", "[contact]") {
  Sheet sheet;
  TouchSolver solver = sheet.solver();
  const test::GapFunction gap = ball(0.003f);
  solver.advance(sheet.state, gap);
  REQUIRE(solver.request(sheet.state, sheet.load));
  REQUIRE(solver.refine(sheet.state, sheet.load, sheet.exact()));
  double before = sheet.force();
  const double first = before;
  double largest = 0;
  for (int frame = 0; frame < sheet.settings.blend_frames; ++frame) {
    // No other load is requested until it is blended in.
    CHECK(!solver.request(sheet.state, sheet.load));
    solver.advance(sheet.state, gap);
    largest = std::max(largest, std::abs(sheet.force() - before));
    before = sheet.force();
  }
  CHECK(solver.request(sheet.state, sheet.load));
  CHECK(largest < 0.3 * std::abs(before - first));
}

TEST_CASE("a correction ends when the obstacle leaves, and acts again when it returns",
          "[contact]") {
  Sheet sheet;
  TouchSolver solver = sheet.solver();
  sheet.refine(solver, ball(0.003f), 2);
  const double force = sheet.force();
  solver.advance(sheet.state, ball(-0.005f));
  CHECK(sheet.state.forces.empty());
  CHECK(sheet.state.u.isZero(0));
  solver.advance(sheet.state, ball(0.003f));
  CHECK(sheet.force() == Approx(force).epsilon(tolerance(1e-3, "Newton's last step")));
}

TEST_CASE("a correction fades without a jump where the object slides on", "[contact]") {
  Sheet sheet, plain;
  TouchSolver solver = sheet.solver(), other = plain.solver();
  sheet.refine(solver, ball(0.003f));
  other.advance(plain.state, ball(0.003f));
  double largest = 0, usual = 0;
  float x = 0;
  for (; x < 0.03f; x += 0.0005f) {
    const Matrix3Xf before = sheet.state.u, plain_before = plain.state.u;
    solver.advance(sheet.state, ball(0.003f, x));
    other.advance(plain.state, ball(0.003f, x));
    largest = std::max(largest, apart(sheet.state.u, before));
    usual = std::max(usual, apart(plain.state.u, plain_before));
  }
  CHECK(largest < 1.2 * usual);
  CHECK(sheet.state.refinement.weights[1] < 0.1f);
  CHECK(sheet.force() == Approx(plain.force()).epsilon(tolerance(0.01, "hardly corrected")));
}

TEST_CASE("a full-order solution far from the tables' is refused and changes nothing",
          "[contact]") {
  Sheet sheet;
  TouchSolver solver = sheet.solver();
  solver.advance(sheet.state, ball(0.003f));
  REQUIRE(solver.request(sheet.state, sheet.load));
  const Matrix3Xf far = 2 * sheet.load.tables;
  Matrix3Xf broken = sheet.load.tables;
  broken(0, 0) = std::numeric_limits<float>::quiet_NaN();
  for (const Matrix3Xf& solution : {far, broken}) {
    CHECK(!solver.refine(sheet.state, sheet.load, solution));
    CHECK(!sheet.state.refinement.acts());
    CHECK(solver.request(sheet.state, sheet.load));
  }
}

TEST_CASE("no load is requested for a body at rest", "[contact]") {
  Sheet sheet;
  TouchSolver solver = sheet.solver();
  CHECK(!solver.request(sheet.state, sheet.load));
  solver.advance(sheet.state, ball(-0.005f));
  CHECK(!solver.request(sheet.state, sheet.load));
}

TEST_CASE("refined frames allocate nothing and are the same again", "[contact]") {
  Sheet sheet;
  TouchSolver solver = sheet.solver();
  sheet.refine(solver, ball(0.003f), 2);
  const Matrix3Xf exact = sheet.exact();
  const TouchState from = sheet.state;
  std::vector<test::GapFunction> gaps;
  for (int frame = 0; frame < 9; ++frame)
    gaps.push_back(ball(0.0032f, 0.0003f * static_cast<float>(frame)));
  const auto run_frames = [&] {
    for (const test::GapFunction& gap : gaps) {
      if (solver.request(sheet.state, sheet.load))
        (void)solver.refine(sheet.state, sheet.load, exact);
      solver.advance(sheet.state, gap);
    }
  };
  run_frames();
  CHECK(test::allocations_during(run_frames) == 0);
  TouchState first = from;
  std::swap(first, sheet.state);
  run_frames();
  first = from;
  std::swap(first, sheet.state);
  run_frames();
  CHECK(std::memcmp(first.u.data(), sheet.state.u.data(),
                    sizeof(float) * static_cast<std::size_t>(first.u.size())) == 0);
}

}  // namespace
}  // namespace palpable
