#include "palpable/desk/film/desk_renderer.h"

#include "tests/support/desk_squares.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

using namespace palpable;
using namespace palpable::test;

TEST_CASE("a point appears in both raw images where the rig projects it", "[film][gl]") {
  SensorFaults faults;
  faults.row_error_px = 0.09;
  std::vector<PaintedMesh> squares;
  std::vector<Eigen::Vector3d> points;
  for (const double z : {0.30, 0.60, 1.10})
    for (const double y : {-0.38, 0.02, 0.36})
      for (const double x : {-0.72, -0.25, 0.04, 0.30, 0.76}) {
        // Each depth has its own rows, so that squares at one depth do not hide those at another.
        const double row = y + 0.14 * (z - 0.6);
        points.emplace_back(x * z, row * z, z);
        squares.push_back(square(points.back(), 0.0150 * z, 1));
      }
  std::optional<DeskRenderer> renderer = renderer_of(scene_of(squares), 1, faults);
  if (!renderer) PALPABLE_SKIP(kNoGl);
  RawPair pair;
  renderer->draw(still(0), pair);

  const StereoRig rig = zed_mini_rig();
  double rows = 0.0;
  int seen = 0;
  for (const Eigen::Vector3d& x : points) {
    INFO("point " << x.transpose());
    const Eigen::Vector2d in_left = rig.left.project(x);
    const Eigen::Vector2d in_right = rig.right.project(rig.right_from_left * x);
    const auto inside = [](const Eigen::Vector2d& p) {
      return p.x() > 10 && p.y() > 10 && p.x() < 1269 && p.y() < 709;
    };
    if (inside(in_left)) {
      CHECK((bright_spot(pair.left, in_left) - in_left).norm() <=
            tolerance(0.1, "a spot of 10 px, filtered twice, with noise"));
      ++seen;
    }
    if (inside(in_right)) {
      const Eigen::Vector2d off = bright_spot(pair.right, in_right) - in_right;
      CHECK(off.norm() <= tolerance(0.2, "the same, and the row error of 0.09 px"));
      rows += off.y();
      ++seen;
    }
  }
  CHECK(seen > 60);
  CHECK(std::abs(rows / (seen / 2.0) - faults.row_error_px) <=
        tolerance(0.03, "the mean of 35 spots"));
  CHECK(renderer->gl_error_count() == 0);
}

TEST_CASE("the depth of the truth is the analytic Z of planes and capsules", "[film][gl]") {
  DeskScene scene = scene_of({square({0, 0, 0.9}, 2.0, 0)});
  // The plane is tilted: its far edge lies 0.5 m behind its near one.
  for (PaintedVertex& vertex : scene.meshes[0].vertices)
    vertex.position.z() -= 0.25F * vertex.position.y();
  std::optional<DeskRenderer> renderer = renderer_of(scene, 1, {});
  if (!renderer) PALPABLE_SKIP(kNoGl);
  HandPose pose;
  pose.desk_from_wrist = Eigen::Translation3d(0.02, 0.03, 0.35) *
                         Eigen::AngleAxisd(2.2, Eigen::Vector3d(1, 0.3, 0.2).normalized());
  pose.elbow = {-0.15, 0.10, 0.42};
  pose.shoulder = {-0.30, 0.10, 0.50};
  const std::vector<HandCapsule> hand = hand_capsules(pose);
  const std::vector<Capsule> shapes = shapes_of(hand);
  const PinholeCamera view{213, 121, 130, 131, 104.3, 61.8};
  DeskTruth truth;
  renderer->draw_truth(still(0, hand), view, 0.063, truth);
  const DepthImage& depth = truth.depth;
  REQUIRE(depth.width() == 213);

  int on_hand = 0, on_plane = 0, wrong = 0;
  for (int v = 0; v < view.height; ++v)
    for (int u = 0; u < view.width; ++u) {
      const Eigen::Vector3d ray = view.unproject(u, v, 1.0);
      const double plane = 0.9 / (1.0 + 0.25 * ray.y());
      const double along = ray_distance(shapes, Eigen::Vector3d::Zero(), ray.normalized(), 1.5);
      const double z = std::min(plane, along / ray.norm());
      if (z < plane) {
        // At the rim, a chord error of 0.09 mm sideways causes a much larger error in depth.
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        double nearest = 1.0;
        for (const Capsule& c : shapes)
          if (signed_distance(c, z * ray) < nearest) {
            nearest = signed_distance(c, z * ray);
            normal = CapsuleField(c).normal(z * ray);
          }
        if (-normal.dot(ray.normalized()) < 0.35) continue;
        ++on_hand;
      } else {
        // Next to the rim, the silhouette of the triangles may be narrower by the chord error.
        if (signed_distance(shapes, std::min(z, 0.45) * ray) < 0.002) continue;
        ++on_plane;
      }
      if (!(std::abs(depth(u, v) - z) <=
            tolerance(1e-3, "0.09 mm of chord, seen at up to 70 degrees")))
        ++wrong;
    }
  CHECK(on_hand > 1000);
  CHECK(on_plane > 10000);
  CHECK(wrong == 0);
}

TEST_CASE("where nothing is the depth is unknown", "[film][gl]") {
  std::optional<DeskRenderer> renderer = renderer_of(scene_of({square({0, 0, 1}, 0.1, 0)}), 1, {});
  if (!renderer) PALPABLE_SKIP(kNoGl);
  DeskTruth truth;
  renderer->draw_truth(still(0), {64, 48, 40, 40, 31.5, 23.5}, 0.063, truth);
  const DepthImage& depth = truth.depth;
  CHECK(std::isnan(depth(0, 0)));
  CHECK(std::abs(depth(31, 23) - 1.0F) <= tolerance(1e-6, "float"));
}

TEST_CASE("noise is 0.6 to 0.8 grey levels, new in every frame and the same for the same seed",
          "[film][gl]") {
  const DeskScene scene = scene_of({square({0, 0, 1}, 5.0, 0)});
  SensorFaults faults;
  faults.right_gain = 1.025;
  std::optional<DeskRenderer> first = renderer_of(scene, 3, faults);
  if (!first) PALPABLE_SKIP(kNoGl);
  RawPair a, b, other;
  first->draw(still(7), a);
  first->draw(still(8), b);

  double squares = 0.0, sum = 0.0;
  int count = 0;
  for (int y = 260; y < 460; ++y)
    for (int x = 540; x < 740; ++x) {
      const double difference = luma(a.left(x, y)) - luma(b.left(x, y));
      squares += difference * difference;
      sum += luma(a.left(x, y));
      ++count;
    }
  const double noise = std::sqrt(0.5 * squares / count);
  CHECK(noise > 0.6);
  CHECK(noise < 0.8);
  CHECK(sum / count > 60.0);  // not so dark or bright that clipping would hide the noise
  CHECK(sum / count < 230.0);

  // The gain applies to linear light; pictures hold its square root.
  double right = 0.0;
  for (int y = 260; y < 460; ++y)
    for (int x = 540; x < 740; ++x) right += luma(a.right(x, y));
  CHECK(std::abs(right / sum - std::sqrt(1.025)) <=
        tolerance(0.002, "vignetting about two centres"));

  std::optional<DeskRenderer> second = renderer_of(scene, 3, faults);
  REQUIRE(second);
  second->draw(still(7), other);
  CHECK(other.left == a.left);
  CHECK(other.right == a.right);
  std::optional<DeskRenderer> third = renderer_of(scene, 4, faults);
  REQUIRE(third);
  third->draw(still(7), other);
  CHECK(other.left != a.left);
}

TEST_CASE("corners are darker than the middle by the vignetting", "[film][gl]") {
  DeskRenderer* renderer = wall_renderer({});
  if (!renderer) PALPABLE_SKIP(kNoGl);
  RawPair pair;
  renderer->draw(still(0), pair);
  const auto mean = [&](int x0, int y0) {
    double sum = 0.0;
    for (int y = y0; y < y0 + 12; ++y)
      for (int x = x0; x < x0 + 12; ++x) sum += std::pow(luma(pair.left(x, y)), 2.0);
    return sum / 144.0;
  };
  CHECK(std::abs(mean(0, 0) / mean(644, 354) - (1.0 - SensorFaults{}.vignetting)) <=
        tolerance(0.02, "the first block lies 10 px from the corner, grey levels are rounded"));
}

TEST_CASE("a hand changes the picture of the desk, which is the same again when the hand has gone",
          "[film][gl]") {
  DeskRenderer* renderer = wall_renderer({0.0, 1.0, 0.2, 0.0});
  if (!renderer) PALPABLE_SKIP(kNoGl);
  HandPose pose;
  pose.desk_from_wrist = Eigen::Translation3d(0.0, 0.0, 0.4) *
                         Eigen::AngleAxisd(std::acos(-1.0), Eigen::Vector3d::UnitX());
  pose.elbow = {-0.25, 0.0, 0.4};
  pose.shoulder = {-0.5, 0.0, 0.4};
  RawPair before, with, after;
  renderer->draw(still(0), before);
  renderer->draw(still(1, hand_capsules(pose)), with);
  renderer->draw(still(2), after);
  CHECK(before.left == after.left);
  int changed = 0;
  for (int y = 0; y < 720; ++y)
    for (int x = 0; x < 1280; ++x) changed += before.left(x, y) != with.left(x, y) ? 1 : 0;
  CHECK(changed > 20000);
  CHECK(changed < 700000);
  CHECK(renderer->gl_error_count() == 0);
}

TEST_CASE("shadows of still things and of movers fall on the desk's top and on movers",
          "[film][gl]") {
  // The camera is 1 m above the desk. A roof of 12 cm is 30 cm from a ball towards the sun.
  const Eigen::Vector3d to_sun = Eigen::Vector3d(-0.46, -0.30, 0.84).normalized();
  const Eigen::Vector3d ball_at(0.0, 0.0, 0.2);
  const auto on_desk = [&](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(x - x.z() / to_sun.z() * to_sun);
  };
  PaintedMesh desk = square({0, 0, 0}, 1.0, 0);
  for (PaintedVertex& vertex : desk.vertices) vertex.normal = {0, 0, 1};
  const PaintedMesh roof = square(ball_at + 0.3 * to_sun, 0.06, 0);
  HandCapsule ball;
  ball.shape = {ball_at, ball_at + Eigen::Vector3d(0, 0, 0.0001), 0.03, 0.03};
  const DistortedCamera eye = zed_mini_rig().left;
  Rigid3 camera_from_desk = Rigid3::Identity();
  camera_from_desk.linear().diagonal() << 1, -1, -1;
  camera_from_desk.translation().z() = 1.0;

  // The mean luma round the picture of a point.
  const auto seen = [&](const ColorImage& image, const Eigen::Vector3d& x) {
    const Eigen::Vector2d at = eye.project(camera_from_desk * x);
    double sum = 0.0;
    for (int v = -3; v <= 3; ++v)
      for (int u = -3; u <= 3; ++u)
        sum += luma(image(static_cast<int>(at.x()) + u, static_cast<int>(at.y()) + v)) / 49.0;
    return sum;
  };
  const auto draw = [&](const std::vector<PaintedMesh>& meshes) {
    std::optional<DeskRenderer> renderer = renderer_of(scene_of(meshes), 1, kFaultless);
    RawPair pair;
    if (!renderer) return pair;
    DeskMoment moment = still(0, {ball});
    moment.camera_from_desk = [&](double) { return camera_from_desk; };
    renderer->draw(moment, pair);
    return pair;
  };
  const RawPair open = draw({desk});
  if (open.left.empty()) PALPABLE_SKIP(kNoGl);
  const RawPair roofed = draw({desk, roof});
  const Eigen::Vector3d top_of_ball = ball_at + Eigen::Vector3d(0, 0, 0.03);
  const Eigen::Vector3d under_ball = on_desk(ball_at);
  const Eigen::Vector3d under_roof = on_desk(ball_at + Eigen::Vector3d(0.045, 0.03, 0.0));
  const Eigen::Vector3d beside = on_desk(ball_at + Eigen::Vector3d(0.0, 0.10, 0.0));
  // Light of the room alone compared with room and sun: 0.5 to 1.4.
  constexpr double kShaded = 0.75;
  CHECK(seen(open.left, under_ball) < kShaded * seen(open.left, beside));
  CHECK(seen(open.left, under_roof) > 0.95 * seen(open.left, beside));
  CHECK(seen(roofed.left, under_roof) < kShaded * seen(open.left, under_roof));
  CHECK(seen(roofed.left, beside) > 0.95 * seen(open.left, beside));
  CHECK(seen(roofed.left, top_of_ball) < kShaded * seen(open.left, top_of_ball));
}

TEST_CASE("labels mark what moves and what the right eye sees, too", "[film][gl]") {
  // A wall at 1 m and a ball in front of it, which hides a part of the wall from the right eye.
  DeskRenderer* renderer = wall_renderer({});
  if (!renderer) PALPABLE_SKIP(kNoGl);
  HandCapsule ball;
  ball.shape = {{0, 0, 0.4}, {0, 0, 0.4001}, 0.05, 0.05};
  const PinholeCamera view{320, 180, 175, 175, 159.5, 89.5};
  constexpr double kBaseline = 0.063;
  DeskTruth truth;
  renderer->draw_truth(still(0, {ball}), view, kBaseline, truth);
  int wrong = 0;
  int moving = 0;
  int hidden = 0;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const double z = truth.depth(x, y);
      const bool moves = (truth.labels(x, y) & kMovesLabel) != 0;
      const bool both = (truth.labels(x, y) & kBothSeeLabel) != 0;
      wrong += moves != (z < 0.9) ? 1 : 0;
      moving += moves ? 1 : 0;
      const Eigen::Vector3d point = view.unproject(x, y, z);
      const Eigen::Vector3d right_eye(kBaseline, 0, 0);
      const Eigen::Vector3d ray = point - right_eye;
      const std::vector<Capsule> shapes = {ball.shape};
      const double met = ray_distance(shapes, right_eye, ray.normalized(), 2.0);
      const double u = view.project(ray).x();
      const bool truly = met > ray.norm() - 0.004 && u >= 0.0 && u <= view.width - 1.0;
      hidden += truly ? 0 : 1;
      // Within a pixel of a border, both labels are accepted.
      const double beside = std::min(signed_distance(shapes, right_eye + 0.4 / ray.z() * ray),
                                     signed_distance(shapes, 0.4 / z * point));
      if (both != truly && std::abs(beside) > 0.006 && u > 1.0 && u < view.width - 2.0) ++wrong;
    }
  CHECK(moving > 1000);
  CHECK(hidden > 1000);
  CHECK(wrong == 0);
}

TEST_CASE("the row offset of the rig moves the right image down", "[film][gl]") {
  std::optional<DeskRenderer> renderer =
      renderer_of(scene_of({square({0, 0.1, 0.8}, 0.015, 1)}), 1, kFaultless);
  if (!renderer) PALPABLE_SKIP(kNoGl);
  const StereoRig rig = zed_mini_rig();
  const Eigen::Vector3d point(0, 0.1, 0.8);
  const Eigen::Vector2d in_right = rig.right.project(rig.right_from_left * point);
  const Eigen::Vector2d in_left = rig.left.project(point);
  DeskMoment moment = still(0);
  RawPair before, after;
  renderer->draw(moment, before);
  moment.rig.row_offset_px = 1.5;
  renderer->draw(moment, after);
  const double sunk =
      bright_spot(after.right, in_right).y() - bright_spot(before.right, in_right).y();
  CHECK(std::abs(sunk - 1.5) <= tolerance(0.05, "grey levels are rounded"));
  CHECK(bright_spot(after.left, in_left) == bright_spot(before.left, in_left));
}

TEST_CASE("half of the light gives half of the linear intensity", "[film][gl]") {
  DeskRenderer* renderer = wall_renderer(kFaultless);
  if (!renderer) PALPABLE_SKIP(kNoGl);
  DeskMoment moment = still(0);
  RawPair full, half;
  renderer->draw(moment, full);
  moment.rig.light = 0.5;
  renderer->draw(moment, half);
  CHECK(std::abs(luma(half.left(640, 360)) / luma(full.left(640, 360)) - std::sqrt(0.5)) <=
        tolerance(0.01, "rounded to grey levels"));
}
