#include "palpable/desk/score/trajectory_score.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;
using test::tolerance;

Rigid3 at(double x, double y, double z) { return Rigid3(Eigen::Translation3d(x, y, z)); }

Rigid3 some_pose(std::mt19937_64& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return Vector3d(number(random), number(random), number(random)); };
  return Eigen::Translation3d(vector()) * AngleAxisd(3 * number(random), vector().normalized());
}

TEST_CASE("four positions that are off by a known length have that absolute error", "[score]") {
  // A square of 2 m. The found corners are alternately 3 mm above and below it; no rigid motion
  // brings them nearer, since the optimal plane through them is the square's own.
  const Vector3d corners[] = {{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}};
  std::vector<PosePair> pairs;
  for (int i = 0; i < 4; ++i) {
    const Vector3d x = corners[i];
    pairs.push_back({0.1 * i, at(x.x(), x.y(), 0), at(x.x(), x.y(), i % 2 == 0 ? 0.003 : -0.003)});
  }
  const TrajectoryScore score = score_trajectory(pairs);
  CHECK(score.poses == 4);
  CHECK(score.ate == Approx(0.003));
  CHECK_FALSE(score.rpe.has_value());  // the path of 0.3 s is shorter than the span
}

TEST_CASE("the start and the orientation of a path do not matter", "[score][law]") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    const Rigid3 elsewhere = some_pose(random);
    std::vector<PosePair> pairs;
    for (int i = 0; i < 40; ++i) {
      const Rigid3 pose = some_pose(random);
      pairs.push_back({0.1 * i, pose, elsewhere * pose});
    }
    const TrajectoryScore score = score_trajectory(pairs);
    CHECK(score.ate <= tolerance(1e-12, "rounding of metres"));
    CHECK(*score.rpe <= tolerance(1e-12, "rounding of metres"));
    CHECK(*score.rpe_angle <= tolerance(1e-7, "arc cosine near 1"));
  }
}

TEST_CASE("a mirrored path is not aligned by a mirror", "[score]") {
  std::vector<PosePair> pairs;
  const Vector3d points[] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  for (int i = 0; i < 4; ++i) {
    const Vector3d x = points[i];
    pairs.push_back({0.1 * i, at(x.x(), x.y(), x.z()), at(-x.x(), x.y(), x.z())});
  }
  CHECK(align_positions(pairs).linear().determinant() == Approx(1));
  CHECK(score_trajectory(pairs).ate > 0.1);
}

TEST_CASE("a path of the wrong size keeps its error: there is no scale", "[score]") {
  // Two points 2 m apart, found 1 m apart: each has an error of 0.5 m.
  const std::vector<PosePair> pairs{{0, at(-1, 0, 0), at(-0.5, 0, 0)},
                                    {1, at(1, 0, 0), at(0.5, 0, 0)}};
  CHECK(score_trajectory(pairs).ate == Approx(0.5));
}

TEST_CASE("a camera that is thought to stand still has the true path's spread as error",
          "[score]") {
  const std::vector<PosePair> pairs{{0, at(0, 0, 0), at(0, 0, 0)}, {1, at(0.2, 0, 0), at(0, 0, 0)}};
  CHECK(score_trajectory(pairs).ate == Approx(0.1));
  CHECK(*score_trajectory(pairs).rpe == Approx(0.2));
}

TEST_CASE("a steady drift of 4 mm and 0.01 rad in a second is the relative error", "[score]") {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 90; ++i) {
    const double t = i / 30.0;
    pairs.push_back({t, at(0.5 * t, 0, 0),
                     at(0.5 * t, 0.004 * t, 0) * Rigid3(AngleAxisd(0.01 * t, Vector3d::UnitY()))});
  }
  // The found motion over a second is rotated by the angle at its start, which changes the 0.5 m of
  // later seconds by up to 0.5 * 0.02 m. Only the first second has the drift alone.
  const TrajectoryScore first = score_trajectory(std::span(pairs).first(31));
  CHECK(*first.rpe == Approx(0.004));
  CHECK(*first.rpe_angle == Approx(0.01));
  CHECK(*score_trajectory(pairs).rpe_angle == Approx(0.01));
}

TEST_CASE("the relative error is over one second, not over frames", "[score]") {
  std::vector<PosePair> slow;
  std::vector<PosePair> fast;
  for (int i = 0; i <= 40; ++i) slow.push_back({i / 10.0, at(0, 0, 0), at(0.003 * i / 10.0, 0, 0)});
  for (int i = 0; i <= 120; ++i)
    fast.push_back({i / 30.0, at(0, 0, 0), at(0.003 * i / 30.0, 0, 0)});
  CHECK(*score_trajectory(slow).rpe == Approx(0.003));
  CHECK(*score_trajectory(fast).rpe == Approx(0.003));
}

TEST_CASE("over a gap of more than half a second nothing is compared", "[score]") {
  const std::vector<PosePair> pairs{{0, at(0, 0, 0), at(0, 0, 0)}, {1.6, at(0, 0, 0), at(9, 0, 0)}};
  CHECK_FALSE(score_trajectory(pairs).rpe.has_value());
}

TEST_CASE("poses are paired with the nearest in time, unless it is too far away", "[score]") {
  const std::vector<StampedPose> truth{
      {0.0, at(0, 0, 0)}, {0.1, at(1, 0, 0)}, {0.2, at(2, 0, 0)}, {0.9, at(9, 0, 0)}};
  const std::vector<StampedPose> found{
      {0.004, at(0, 1, 0)}, {0.09, at(1, 1, 0)}, {0.11, at(1, 2, 0)}, {0.2, at(2, 1, 0)}};
  const auto pairs = match_in_time(truth, found, 0.0167);
  REQUIRE(pairs.size() == 3);
  CHECK(pairs[0].found.translation() == Vector3d(0, 1, 0));
  CHECK(pairs[1].found.translation().x() == 1);
  CHECK(pairs[2].truth.translation() == Vector3d(2, 0, 0));
  CHECK(pairs[2].found.translation() == Vector3d(2, 1, 0));
  CHECK(match_in_time(truth, {}, 1).empty());
  CHECK(match_in_time({}, found, 1).empty());
}

TEST_CASE("an empty list of poses is refused", "[score][errors]") {
  CHECK_THROWS_AS(score_trajectory({}), ContractViolation);
  const std::vector<PosePair> one{{0, at(0, 0, 0), at(1, 2, 3)}};
  CHECK_THROWS_AS(score_trajectory(one, 0), ContractViolation);
  CHECK(score_trajectory(one).ate <= tolerance(1e-15, "rounding"));
}

}  // namespace
}  // namespace palpable
