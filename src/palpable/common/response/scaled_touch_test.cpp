#include "palpable/common/response/touch_solver.h"
#include "palpable/common/response/touchable_body.h"
#include "tests/support/ball_gap.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/elastic_sheet.h"
#include "tests/support/test.h"

#include <Eigen/Core>

namespace palpable {
namespace {

using Eigen::Vector3f;
using test::tolerance;

constexpr float kScale = 10;

test::GapFunction ball(float radius, float depth) {
  return test::gap_to_ball(Vector3f(0, 0, radius - depth), radius, kScale * kGapReach);
}

TEST_CASE("a body ten times as large takes a similar shape under an obstacle ten times as large",
          "[contact]") {
  const test::ElasticSheet sheet;
  TouchableBody small(test::DentedSphere{}.body(), sheet.tables);
  small.body.surface = sheet.skin;
  const TouchableBody large = scaled(small, static_cast<double>(kScale));
  REQUIRE(large.touch);
  TouchSettings settings;
  settings.softness = 1e-3;
  TouchSettings far = settings;
  for (double* length : {&far.band, &far.largest_step, &far.tolerance, &far.entry}) {
    *length *= static_cast<double>(kScale);
  }
  TouchSolver one(small.body.surface, sheet.fixed, *small.touch, settings);
  TouchSolver ten(large.body.surface, sheet.fixed, *large.touch, far);
  TouchState of_one, of_ten;
  for (const float depth : {0.001f, 0.003f}) {
    one.advance(of_one, ball(0.02f, depth));
    ten.advance(of_ten, ball(kScale * 0.02f, kScale * depth));
  }
  REQUIRE(of_one.forces.size() >= 4);
  CHECK(of_ten.u.isApprox(kScale * of_one.u, 1e-3f));
  float force = 0, tenfold = 0;
  for (const PointForce& f : of_one.forces) force += f.force.norm();
  for (const PointForce& f : of_ten.forces) tenfold += f.force.norm();
  CHECK(tenfold == Approx(kScale * kScale * force).epsilon(tolerance(1e-3, "16 bits")));
}

}  // namespace
}  // namespace palpable
