#include "palpable/desk/score/camera_scores.h"

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

TEST_CASE("a body drawn 3 mm to the left and to the right by turns has a jitter of 3 mm",
          "[score]") {
  AnchorScorer scorer;
  CHECK_FALSE(scorer.jitter().has_value());
  for (int n = 0; n < 10; ++n)
    scorer.add(Rigid3::Identity(), at(n % 2 == 0 ? 0.003 : -0.003, 0.1, 0.5));
  CHECK(*scorer.jitter() == Approx(0.003));
}

TEST_CASE("a body that moves with a camera that is assumed fixed jitters by the camera's motion",
          "[score]") {
  AnchorScorer scorer;
  // 0, 6 and 12 mm: mean 6 mm, squared deviations 36, 0 and 36 mm^2
  for (const double x : {0.0, 0.006, 0.012}) scorer.add(at(x, 0, 0), at(0, 0, 0.5));
  CHECK(*scorer.jitter() == Approx(std::sqrt(24.0) * 1e-3));
}

TEST_CASE("a body that stays where it is in the world does not jitter, however the camera moves",
          "[score][law]") {
  auto random = test::random_case(1);
  std::uniform_real_distribution<double> number(-1, 1);
  const Rigid3 world_from_body = at(0.3, -0.1, 0.6);
  AnchorScorer scorer;
  for (int n = 0; n < 50; ++n) {
    const Vector3d axis = Vector3d(number(random), number(random), number(random)).normalized();
    const Rigid3 camera = at(number(random), number(random), number(random)) *
                          Rigid3(AngleAxisd(number(random), axis));
    scorer.add(camera, camera.inverse() * world_from_body);
  }
  CHECK(*scorer.jitter() <= tolerance(1e-12, "rounding of metres"));
}

TEST_CASE("a wrong but constant position is no jitter", "[score]") {
  AnchorScorer scorer;
  for (int n = 0; n < 3; ++n) scorer.add(Rigid3::Identity(), at(5, 5, 5));
  CHECK(*scorer.jitter() == 0);
}

// An offset of 0.1 px, and of 0.6 px from frame 3 on.
const std::vector<TrueRowOffset> kTruth{{0, 0.1}, {1, 0.1}, {2, 0.1}, {3, 0.6, true},
                                        {4, 0.6}, {5, 0.6}, {6, 0.6}};

TEST_CASE("after a step that is corrected in time, the remaining error counts", "[score]") {
  // With 2 frames to settle, frames 3, 4 and 5 do not count.
  const std::vector<RowCorrection> found{{0, 0.08}, {4, 0.3}, {6, 0.55}};
  CHECK(*largest_row_error(kTruth, found, 2) == Approx(0.05));
  CHECK(*largest_row_error(kTruth, found, 1) == Approx(0.3));  // frame 5 still has 0.3
}

TEST_CASE("a step that is never corrected is the error", "[score]") {
  CHECK(*largest_row_error(kTruth, std::vector<RowCorrection>{{0, 0.1}}, 2) == Approx(0.5));
}

TEST_CASE("a correction holds until the next, and is 0 before the first", "[score]") {
  CHECK(*largest_row_error(kTruth, std::vector<RowCorrection>{{3, 0.6}}, 0) == Approx(0.1));
}

TEST_CASE("too large a correction counts like too small a one", "[score]") {
  CHECK(*largest_row_error(kTruth, std::vector<RowCorrection>{{0, 0.4}, {3, 0.6}}, 2) ==
        Approx(0.3));
}

TEST_CASE("a frame that was not processed has no row error, but its step counts", "[score]") {
  const std::vector<RowCorrection> found{{0, 0.1}, {6, 0.6}};
  const std::vector<std::uint8_t> without_4_and_5{1, 1, 1, 1, 0, 0, 1};
  CHECK(*largest_row_error(kTruth, found, 0) == Approx(0.5));
  CHECK(*largest_row_error(kTruth, found, 0, without_4_and_5) == Approx(0.0));
  const std::vector<std::uint8_t> without_the_step{1, 1, 1, 0, 1, 1, 1};
  CHECK(*largest_row_error(kTruth, found, 2, without_the_step) == Approx(0.0));
  CHECK_THROWS_AS(largest_row_error(kTruth, {}, 0, std::vector<std::uint8_t>{1}),
                  ContractViolation);
}

TEST_CASE("where all frames are just after a step there is no error", "[score]") {
  CHECK_FALSE(
      largest_row_error(std::vector<TrueRowOffset>{{0, 3, true}, {1, 3}}, {}, 5).has_value());
  CHECK_FALSE(largest_row_error({}, {}, 0).has_value());
  CHECK_THROWS_AS(largest_row_error({}, {}, -1), ContractViolation);
}

}  // namespace
}  // namespace palpable
