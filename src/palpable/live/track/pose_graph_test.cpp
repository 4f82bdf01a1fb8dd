#include "palpable/live/track/pose_graph.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

using test::tolerance;

using test::tolerance;

Rigid3 pose_of(double a, double b, double c, double x, double y, double z) {
  Twist twist;
  twist << x, y, z, a, b, c;
  return moved_by(twist, Rigid3::Identity());
}

Rigid3 inverse(const Rigid3& T) { return T.inverse(Eigen::Isometry); }

// A camera that turns once around itself in `count` steps and walks a circle while it does.
Rigid3 circle(int k, int count) {
  const double angle = 2 * 3.14159265358979 * k / count;
  return inverse(Rigid3(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY())) *
                 Eigen::Translation3d(0, 0.1 * std::sin(2 * angle), 0.5));
}

TEST_CASE("the derivatives of a tie are those of differences", "[track]") {
  PoseTie tie;
  for (const double turned : {0.0, 1e-4, 0.3, 2.0}) {
    INFO("turned by " << turned);
    tie.b_from_a = pose_of(0.3, -0.4, 0.2, 0.5, 0.1, -0.3);
    const Rigid3 a = pose_of(-0.2, 0.1, 0.5, 1, 2, 3);
    const Rigid3 b =
        pose_of(0.6 * turned, -0.48 * turned, 0.64 * turned, 0.1, -0.2, 0.05) * tie.b_from_a * a;
    const TieResidual here = residual_of(tie, a, b);
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 6; ++i) {
      const Twist s = kStep * Twist::Unit(i);
      const Twist by_a =
          (residual_of(tie, moved_by(s, a), b).r - residual_of(tie, moved_by(-s, a), b).r) /
          (2 * kStep);
      const Twist by_b =
          (residual_of(tie, a, moved_by(s, b)).r - residual_of(tie, a, moved_by(-s, b)).r) /
          (2 * kStep);
      const double near = tolerance(1e-8, "rounding of numbers near 1 by a step of 1e-6: 1e-10");
      CHECK((here.by_a.col(i) - by_a).norm() < near);
      CHECK((here.by_b.col(i) - by_b).norm() < near);
    }
  }
}

TEST_CASE("poses that were moved find back to where all ties agree", "[track]") {
  constexpr int kCount = 30;
  PoseGraph graph;
  for (int k = 0; k < kCount; ++k) {
    // The errors grow up to 0.4 rad and 0.3 m with the index; the first pose is exact.
    const double off = 1.0 * k / kCount;
    graph.camera_from_world.push_back(
        pose_of(0.1 * off, 0.4 * off, -0.1 * off, 0.3 * off, 0, 0.2 * off) * circle(k, kCount));
    PoseTie tie;
    tie.a = k;
    tie.b = (k + 1) % kCount;
    tie.b_from_a = circle(k + 1, kCount) * inverse(circle(k, kCount));
    graph.ties.push_back(tie);
  }
  const PoseGraphResult result = adjust_pose_graph(graph);
  CHECK(result.solved);
  CHECK(result.first_cost > 0.01);
  CHECK(result.last_cost < tolerance(1e-12, "the square of what the last step left"));
  for (int k = 0; k < kCount; ++k) {
    CHECK(graph.camera_from_world[k].isApprox(circle(k, kCount),
                                              tolerance(1e-6, "what the last step left")));
  }
}

TEST_CASE("an error that a loop shows is shared by the ties as their variances", "[track]") {
  // Poses along a line: ten ties of 0.1 m each, and a loop of 1.1 m. The error of 0.1 m is
  // distributed in proportion to the variances: nine ties have 1 mm, one 3 mm and the loop 1 mm, so
  // there are 9 + 9 + 1 = 19 shares.
  PoseGraph graph;
  for (int k = 0; k <= 10; ++k) {
    graph.camera_from_world.emplace_back(Eigen::Translation3d(-0.1 * k, 0, 0));
    if (k == 0) continue;
    PoseTie tie{k - 1, k, Rigid3(Eigen::Translation3d(-0.1, 0, 0)), k == 4 ? 0.003 : 0.001, 0.01};
    graph.ties.push_back(tie);
  }
  graph.ties.push_back({0, 10, Rigid3(Eigen::Translation3d(-1.1, 0, 0)), 0.001, 0.01});
  REQUIRE(adjust_pose_graph(graph).solved);
  const auto x = [&](std::size_t k) { return -graph.camera_from_world[k].translation().x(); };
  CHECK(x(0) == 0);
  const double near = tolerance(1e-9, "a linear system, its damping 1e-9 of the diagonal");
  CHECK(std::abs(x(1) - (0.1 + 0.1 / 19)) < near);
  CHECK(std::abs(x(4) - x(3) - (0.1 + 0.9 / 19)) < near);
  CHECK(std::abs(x(10) - (1.1 - 0.1 / 19)) < near);
}

TEST_CASE("a pose that hangs on nothing leaves all as they were; ties of nothing are refused",
          "[track]") {
  PoseGraph graph;
  for (int k = 0; k < 3; ++k) graph.camera_from_world.push_back(circle(k, 3));
  graph.ties.push_back({0, 1, pose_of(0, 0.1, 0, 0, 0, 0), 1, 1});
  const PoseGraph before = graph;
  CHECK_FALSE(adjust_pose_graph(graph).solved);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(graph.camera_from_world[k].matrix() == before.camera_from_world[k].matrix());
  }
  graph.ties.push_back({0, 3, Rigid3::Identity(), 1, 1});
  CHECK_THROWS_AS(adjust_pose_graph(graph), ContractViolation);
  graph.ties.back() = {0, 2, Rigid3::Identity(), 0, 1};
  CHECK_THROWS_AS(adjust_pose_graph(graph), ContractViolation);
}

}  // namespace
}  // namespace palpable
