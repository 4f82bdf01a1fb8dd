#include "palpable/live/track/loop.h"

#include "palpable/live/track/window.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <optional>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

constexpr int kCount = 40;
constexpr double kPi = 3.14159265358979323846;
const TrackCamera kCamera{{640, 360, 350, 350, 319.5, 179.5}, 0.063};

// The true pose of keyframe k: once around a circle of 1 m radius, looking outwards.
Rigid3 truth(int k) {
  const Rigid3 world_from_camera =
      Rigid3(Eigen::AngleAxisd(2 * kPi * k / kCount, Eigen::Vector3d::UnitY())) *
      Eigen::Translation3d(0, 0, 1);
  return world_from_camera.inverse(Eigen::Isometry);
}

// The same walk as measured by a tracker whose rotations are 1 % too small, which is 3.6 degrees at
// the end. Each keyframe adds 20 landmarks, 0.5 m in front of it, which the next one sees, too.
struct Circle : LandmarkMap {
  Circle() {
    Rigid3 pose = truth(0);
    for (int k = 0; k < kCount; ++k) {
      if (k > 0) {
        const Rigid3 step = truth(k) * truth(k - 1).inverse(Eigen::Isometry);
        const Eigen::AngleAxisd turn(step.linear());
        Rigid3 seen = step;
        seen.linear() = Eigen::AngleAxisd(0.99 * turn.angle(), turn.axis()).matrix();
        pose = seen * pose;
      }
      Keyframe keyframe;
      keyframe.number = 10 * k;
      keyframe.camera_from_world = pose;
      keyframe.median_depth = 0.5;
      // All keyframes look alike, except the first and the last, which have the same view.
      keyframe.thumbnail = k == 0 || k == kCount - 1 ? Thumbnail{1, 0} : Thumbnail{0, 1};
      keyframes.push_back(keyframe);
      for (int i = 0; i < 20; ++i) {
        Landmark landmark;
        landmark.anchor = k;
        landmark.x_in_world =
            pose.inverse(Eigen::Isometry) * Eigen::Vector3d(0.01 * i - 0.1, 0.01 * i, 0.5);
        landmarks.push_back(landmark);
        see(k, 20 * k + i);
      }
      for (int i = 0; k > 0 && i < 20; ++i) see(k, 20 * (k - 1) + i);
    }
  }
  void see(int k, int id) {
    landmarks[id].sightings.push_back({k, {}});
    keyframes[k].landmarks.push_back(id);
  }
};

// The loop that recognises the first keyframe in the last one, with the true relative pose.
Loop true_loop() {
  return {0, 10 * (kCount - 1), {truth(kCount - 1) * truth(0).inverse(Eigen::Isometry), 40}};
}

double end_error(const Circle& circle) {
  const Rigid3 off =
      circle.keyframes.back().camera_from_world * truth(kCount - 1).inverse(Eigen::Isometry);
  return Eigen::AngleAxisd(off.linear()).angle();
}

TEST_CASE("the keyframe that looks alike and shares no landmark is the one to compare with",
          "[track][loop]") {
  Circle circle;
  CHECK(loop_candidates(circle, 1) == std::vector<int>{0});
  CHECK(loop_candidates(circle, 3).size() == 3);
  // If five of its landmarks are seen, no loop is needed.
  for (int i = 0; i < 5; ++i) circle.see(kCount - 1, i);
  CHECK(loop_candidates(circle, 1) != std::vector<int>{0});
  // Keyframes of the window are never candidates.
  circle.keyframes.resize(kWindow);
  CHECK(loop_candidates(circle, 3).empty());
}

TEST_CASE("a loop takes the drift out of a circle, and landmarks go with their keyframes",
          "[track][loop]") {
  Circle circle;
  const double before = end_error(circle);
  CHECK(before > 0.05);
  const std::vector<Keyframe> drifted = circle.keyframes;
  const std::vector<Landmark> points = circle.landmarks;
  PoseGraph graph = graph_of(kCamera, circle, true_loop()).value();
  CHECK(graph.ties.size() == kCount);  // one between neighbours, and the loop
  REQUIRE(adjust_pose_graph(graph).solved);
  put_back(graph, circle);
  // There are 39 ties of 21 landmarks each and a loop of 40, whose share of the variances is 1
  // / 75.
  CHECK(end_error(circle) < before * tolerance(0.03, "twice the loop's share"));
  CHECK(circle.keyframes.front().camera_from_world.matrix() == truth(0).matrix());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto k = static_cast<std::size_t>(points[i].anchor);
    const Eigen::Vector3d seen = drifted[k].camera_from_world * points[i].x_in_world;
    const Eigen::Vector3d now =
        circle.keyframes[k].camera_from_world * circle.landmarks[i].x_in_world;
    CHECK((seen - now).norm() < tolerance(1e-12, "a few products of numbers near 1"));
  }
}

TEST_CASE("a loop to a keyframe that is no longer kept is none", "[track][loop]") {
  Circle circle;
  Loop loop = true_loop();
  CHECK(graph_of(kCamera, circle, loop).has_value());
  loop.old_number = -7;
  CHECK_FALSE(graph_of(kCamera, circle, loop).has_value());
  loop = true_loop();
  loop.new_number = 1 << 20;
  CHECK_FALSE(graph_of(kCamera, circle, loop).has_value());
}

TEST_CASE("a landmark whose first keyframe is forgotten goes with the oldest that is left",
          "[track][loop]") {
  Circle circle;
  Landmark& landmark = circle.landmarks[20 * 30];
  landmark.anchor = -1;
  landmark.lost_anchor = circle.keyframes[30].camera_from_world;
  const Landmark before = landmark;
  const Rigid3 old = circle.keyframes[30].camera_from_world;
  PoseGraph graph = graph_of(kCamera, circle, true_loop()).value();
  REQUIRE(adjust_pose_graph(graph).solved);
  put_back(graph, circle);
  const Rigid3& now = circle.keyframes[30].camera_from_world;
  const double near = tolerance(1e-12, "a few products of numbers near 1");
  CHECK((now.matrix() - old.matrix()).norm() > 0.01);
  CHECK((now * landmark.x_in_world - old * before.x_in_world).norm() < near);
  CHECK((landmark.lost_anchor.matrix() - now.matrix()).norm() < near);
}

TEST_CASE(
    "landmarks of the last keyframes that the old keyframe also shows are removed when a loop is "
    "closed",
    "[track][loop]") {
  Circle circle;
  const auto alive_of = [&](int k) {
    int count = 0;
    for (int i = 0; i < 20; ++i) { count += circle.landmarks[20 * k + i].alive ? 1 : 0; }
    return count;
  };
  PoseGraph graph = graph_of(kCamera, circle, true_loop()).value();
  REQUIRE(adjust_pose_graph(graph).solved);
  put_back(graph, circle);
  forget_doubles(kCamera, true_loop(), circle);
  CHECK(alive_of(kCount - 1) == 0);  // 9 degrees beside the first, whose picture spans 85 degrees
  CHECK(alive_of(0) == 20);
  CHECK(alive_of(1) == 20);
  CHECK(alive_of(kCount - kWindow) == 20);  // 63 degrees beside it
  CHECK(alive_of(kCount - kWindow - 1) == 20);
}

TEST_CASE(
    "a loop is rejected if it differs by more than plausible drift, or if one of its keyframes was "
    "removed",
    "[track][loop]") {
  Circle circle;
  const auto at = pose_by(true_loop(), circle.keyframes);
  REQUIRE(at);
  CHECK(at->isApprox(truth(kCount - 1), 1e-12));
  // The path is 6 m long with one full turn: 0.9 m is a tenth of both (the depth is 0.5 m).
  Loop far = true_loop();
  far.new_from_old.camera_from_old =
      Eigen::Translation3d(1.2, 0, 0) * far.new_from_old.camera_from_old;
  CHECK_FALSE(pose_by(far, circle.keyframes));
  Loop gone = true_loop();
  gone.old_number = 5;
  CHECK_FALSE(pose_by(gone, circle.keyframes));
}

TEST_CASE("a loop is confirmed when two successive keyframes agree on it, and returned once",
          "[track][loop]") {
  const Circle circle;
  const auto compare = [&](LoopConfirmation& confirmation, const std::optional<Loop>& loop) {
    confirmation.compare(loop, kCamera, 0.5, circle.keyframes);
  };
  LoopConfirmation confirmation;
  compare(confirmation, true_loop());
  CHECK_FALSE(confirmation.take_confirmed());
  compare(confirmation, true_loop());
  CHECK(confirmation.take_confirmed());
  CHECK_FALSE(confirmation.take_confirmed());

  // A keyframe without a loop between them resets the confirmation.
  compare(confirmation, true_loop());
  compare(confirmation, std::nullopt);
  compare(confirmation, true_loop());
  CHECK_FALSE(confirmation.take_confirmed());

  // The two loops differ by 5 degrees, about 30 px.
  Loop other = true_loop();
  other.new_from_old.camera_from_old = Eigen::AngleAxisd(5 * kPi / 180, Eigen::Vector3d::UnitX()) *
                                       other.new_from_old.camera_from_old;
  compare(confirmation, other);
  CHECK_FALSE(confirmation.take_confirmed());
}

}  // namespace
}  // namespace palpable
