#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/response/touch_solver.h"
#include "tests/support/allocations.h"
#include "tests/support/pressed_sheet.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3f;
using test::GapFunction;
using test::tolerance;

// A ball of radius 40 mm that yields where it is pressed, with contact points 2 mm apart.
struct JudgedBall {
  SurfaceMesh skin = sphere_surface({0, 0, 0.04}, 0.04, 3);
  TouchTables tables = test::yielding_tables(skin);
  std::vector<std::uint8_t> fixed =
      std::vector<std::uint8_t>(static_cast<std::size_t>(skin.vertex_count()), 0);
  JudgedBall() { tables.point_spacing = 0.002; }
  [[nodiscard]] TouchSolver solver() const { return {skin, fixed, tables, {.softness = 1e-6}}; }
};

// The place in the uppermost triangle that is farthest from all contact points, and the triangle's
// normal.
struct Spot {
  Eigen::Vector3d at = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
  double from_points = 0;  // m
};
Spot spot_between_points(const SurfaceMesh& skin, const TouchSolver& solver) {
  int top = 0;
  double highest = 0;
  for (int t = 0; t < skin.triangle_count(); ++t) {
    const double z = skin.vertices(2, skin.triangles.col(t)).sum();
    if (z > highest) highest = z, top = t;
  }
  const Eigen::Matrix3d corners = skin.vertices(Eigen::all, skin.triangles.col(top));
  Spot spot;
  spot.normal =
      (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).normalized();
  constexpr int kPieces = 30;
  for (int i = 1; i < kPieces; ++i) {
    for (int j = 1; j < kPieces - i; ++j) {
      const Eigen::Vector3d x = corners * Eigen::Vector3d(i, j, kPieces - i - j) / kPieces;
      const double away = static_cast<double>(
          (solver.places().colwise() - x.cast<float>()).colwise().norm().minCoeff());
      if (away > spot.from_points) spot = {x, spot.normal, away};
    }
  }
  return spot;
}

// A capsule that stands on its tip, `depth` (m) below the skin at a spot.
CapsuleObstacles standing(const Spot& spot, double radius, double depth) {
  CapsuleObstacles obstacles;
  const Eigen::Vector3d tip = spot.at + (radius - depth) * spot.normal;
  obstacles.set(std::vector<Capsule>{{tip, tip + 0.1 * spot.normal, radius, radius}});
  return obstacles;
}

TEST_CASE("a needle between the contact points is said to be inside, and a finger is not",
          "[contact][judged]") {
  const JudgedBall ball;
  TouchSolver solver = ball.solver();
  const Spot spot = spot_between_points(ball.skin, solver);
  REQUIRE(spot.from_points > 8e-4);
  for (const double radius : {1e-4, 5e-4}) {
    TouchState state;
    const TouchReport pierced = solver.advance(state, standing(spot, radius, 0.0025));
    INFO(radius);
    CHECK(state.forces.empty());
    CHECK(pierced.penetration == 0);
    CHECK(pierced.points_inside == 0);
    CHECK(pierced.sharp_inside ==
          Approx(0.0025).margin(tolerance(1e-4, "m: a neighbouring face may be nearer")));
    CHECK(pierced.left() == pierced.sharp_inside);
    CHECK(pierced.reached() == Reached::kNot);
    CHECK(pierced.missed() == pierced.sharp_inside);
    CHECK_FALSE(pierced.stated.has_value());
  }
  // A pencil and a finger are given way to at the same place.
  for (const double radius : {0.0035, 0.008, 0.03}) {
    INFO(radius);
    TouchState state;
    const CapsuleObstacles obstacle = standing(spot, radius, 0.0025);
    for (int frame = 0; frame < 3; ++frame) solver.advance(state, obstacle);
    const TouchReport report = solver.advance(state, obstacle);
    CHECK_FALSE(state.forces.empty());
    CHECK(report.reached() == Reached::kYes);
    CHECK(report.missed() == 0);
    CHECK(report.left() < kReached);
    CHECK(report.sharp_inside == 0);
  }
}

TEST_CASE("a ball around the whole body is said to be inside, whether points are pressed or not",
          "[contact][judged]") {
  const test::PressedSheet sheet;
  TouchSolver solver = sheet.solver();
  for (const Eigen::Vector3d& centre :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.01, 0.02, 0.3)}) {
    CapsuleObstacles around;
    around.set(std::vector<Capsule>{{centre, centre, 1, 1}});
    TouchState state;
    for (int frame = 0; frame < 3; ++frame) {
      const TouchReport report = solver.advance(state, around);
      // No vertex moves by more than 15 mm in a frame, and the ball ends 0.6 m away.
      CHECK(report.left() > 0.6);
      CHECK(report.points_inside > 0.6);
      CHECK(report.points_inside < 1.05);
      CHECK(report.reached() != Reached::kYes);
      CHECK(state.u.allFinite());
    }
  }
}

TEST_CASE("a state is judged at its skin, after the step limit", "[contact][judged]") {
  const test::PressedSheet sheet;
  TouchSolver solver = sheet.solver();
  TouchState state;
  constexpr double kMost = 0.001;  // m
  const GapFunction gap = test::ball_into_sheet(0.02f, 0.004f);
  TouchReport report = solver.advance(state, gap, kMost);
  CHECK(report.inside_before == Approx(0.004).margin(1e-6));
  CHECK(report.points_inside ==
        Approx(0.003).margin(tolerance(1e-4, "m: a point may be pushed on")));
  CHECK(report.penetration < 0.0028);  // before the limit, after a step of 1.25 mm
  CHECK(report.reached() == Reached::kLater);
  CHECK_FALSE(report.stated.has_value());
  for (int frame = 0; frame < 8; ++frame) report = solver.advance(state, gap, kMost);
  CHECK(report.points_inside < tolerance(2e-5, "m: the last step of Newton's method"));
  CHECK(report.reached() == Reached::kYes);
  // The obstacle leaves, and the skin springs back at the same pace.
  CHECK(solver.advance(state, test::nothing_near(), kMost).reached() == Reached::kLater);
  for (int frame = 0; frame < 8; ++frame) {
    report = solver.advance(state, test::nothing_near(), kMost);
  }
  CHECK(report.reached() == Reached::kYes);
  CHECK(report.left() == 0);
}

TEST_CASE("an obstacle in what the support holds is said to be inside", "[contact][judged]") {
  test::PressedSheet sheet;
  for (int v = 0; v < sheet.body.skin.vertex_count(); ++v) {
    sheet.body.fixed[static_cast<std::size_t>(v)] = sheet.body.skin.vertices(0, v) < -0.009;
  }
  TouchSolver solver = sheet.solver();
  TouchState state;
  const TouchReport report =
      solver.advance(state, test::ball_into_sheet(0.02f, 0.003f, Vector3f(-0.020f, 0, 0)));
  CHECK(report.held_inside == Approx(0.003).margin(tolerance(1e-5, "m: a vertex below the ball")));
  CHECK(report.reached() == Reached::kNot);
  CHECK(report.missed() == 0);  // the free skin is solved
}

TEST_CASE("judging a frame allocates nothing", "[contact][judged][allocation]") {
  const JudgedBall ball;
  TouchSolver solver = ball.solver();
  TouchState state;
  const CapsuleObstacles needle = standing(spot_between_points(ball.skin, solver), 1e-4, 0.0025);
  solver.advance(state, test::nothing_near());
  TouchReport report;
  CHECK(test::allocations_during([&] { report = solver.advance(state, needle); }) == 0);
  CHECK(report.sharp_inside > 0);
}

}  // namespace
}  // namespace palpable
