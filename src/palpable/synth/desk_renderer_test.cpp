#include "palpable/synth/desk_renderer.h"

#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

using namespace palpable;
using palpable::test::tolerance;

namespace {

constexpr const char* kNoGl =
    "no OpenGL 4.5 context here (Mesa's libegl1 and libgl1-mesa-dri are enough)";

/// The desk frame is the camera's here: what is placed is where the left eye sees it.
const Rigid3 kSame = Rigid3::Identity();

PaintedMesh square(const Eigen::Vector3d& centre, double half, int image) {
  PaintedMesh mesh;
  mesh.image = image;
  for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
    const Eigen::Vector3d at = centre + half * Eigen::Vector3d(x, y, 0.0);
    const Eigen::Vector2d uv(0.5 + 0.5 * x, 0.5 + 0.5 * y);
    mesh.vertices.push_back(
        {at.cast<float>(), Eigen::Vector3f(0, 0, -1), uv.cast<float>(), {1, 0, 9, 9}});
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// A soft bright spot in the middle of black: unlike an edge, its place does not depend on how a
/// triangle covers pixels.
ColorImage spot_image() {
  ColorImage image(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double r2 = (x - 31.5) * (x - 31.5) + (y - 31.5) * (y - 31.5);
      const auto value = static_cast<std::uint8_t>(std::lround(250.0 * std::exp(-r2 / 200.0)));
      image(x, y) = {value, value, value};
    }
  return image;
}

DeskScene scene_of(std::vector<PaintedMesh> meshes) {
  DeskScene scene;
  scene.images = {ColorImage(4, 4, Rgb{170, 170, 170}), spot_image()};
  scene.meshes = std::move(meshes);
  return scene;
}

std::optional<DeskRenderer> renderer_of(const DeskScene& scene, std::uint64_t seed,
                                        const SensorFaults& faults) {
  DeskLook look;
  look.seed = seed;
  Result<DeskRenderer> made = DeskRenderer::make({zed_mini_rig(), faults, kSame}, scene, look);
  if (!made.ok()) return std::nullopt;
  return std::move(made).value();
}

/// A frame in which camera and movers stand.
DeskMoment still(int frame, std::vector<HandCapsule> hand = {}) {
  return {frame, [](double) { return kSame; },
          [hand = std::move(hand)](double) {
            return Movers{hand, std::nullopt};
          },
          RigState{}};
}

double luma(const Rgb& c) { return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b; }

/// Where the brightness in a window round `near` has its middle.
Eigen::Vector2d bright_spot(const ColorImage& image, const Eigen::Vector2d& near) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0.0;
  const auto u = static_cast<int>(std::lround(near.x()));
  const auto v = static_cast<int>(std::lround(near.y()));
  for (int y = std::max(0, v - 13); y <= std::min(image.height() - 1, v + 13); ++y)
    for (int x = std::max(0, u - 13); x <= std::min(image.width() - 1, u + 13); ++x) {
      const double light = std::pow(luma(image(x, y)) / 255.0, 2.0);  // the sensor stores the root
      if (light < 0.003) continue;                                    // noise on black
      sum += light * Eigen::Vector2d(x, y);
      weight += light;
    }
  return sum / weight;
}

}  // namespace

TEST_CASE("a point's picture lies in both raw images where the rig projects it", "[synth][gl]") {
  SensorFaults faults;
  faults.row_error_px = 0.09;
  std::vector<PaintedMesh> squares;
  std::vector<Eigen::Vector3d> points;
  for (const double z : {0.30, 0.60, 1.10})
    for (const double y : {-0.38, 0.02, 0.36})
      for (const double x : {-0.72, -0.25, 0.04, 0.30, 0.76}) {
        // Squares at one depth do not hide those at another: each depth has its own rows.
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

TEST_CASE("the depth of the truth is the analytic Z of planes and capsules", "[synth][gl]") {
  DeskScene scene = scene_of({square({0, 0, 0.9}, 2.0, 0)});
  // Tilt the plane: its far edge lies 0.5 m behind its near one.
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
        // At the rim a chord's 0.09 mm sideways is much more in depth.
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        double nearest = 1.0;
        for (const Capsule& c : shapes)
          if (signed_distance(c, z * ray) < nearest) {
            nearest = signed_distance(c, z * ray);
            normal = distance_normal(c, z * ray);
          }
        if (-normal.dot(ray.normalized()) < 0.35) continue;
        ++on_hand;
      } else {
        // Next to the rim the triangles' silhouette is a chord narrower or not.
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

TEST_CASE("where nothing is the depth is unknown", "[synth][gl]") {
  std::optional<DeskRenderer> renderer = renderer_of(scene_of({square({0, 0, 1}, 0.1, 0)}), 1, {});
  if (!renderer) PALPABLE_SKIP(kNoGl);
  DeskTruth truth;
  renderer->draw_truth(still(0), {64, 48, 40, 40, 31.5, 23.5}, 0.063, truth);
  const DepthImage& depth = truth.depth;
  CHECK(std::isnan(depth(0, 0)));
  CHECK(std::abs(depth(31, 23) - 1.0F) <= tolerance(1e-6, "float"));
}

TEST_CASE("noise is 0.6 to 0.8 grey levels, new in every frame and the same for the same seed",
          "[synth][gl]") {
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
  CHECK(sum / count > 60.0);  // neither black nor white, where clipping would hide the noise
  CHECK(sum / count < 230.0);

  // The gain is linear; the stored root shows half of it.
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

TEST_CASE("corners are darker than the middle by the vignetting", "[synth][gl]") {
  std::optional<DeskRenderer> renderer = renderer_of(scene_of({square({0, 0, 1}, 5.0, 0)}), 1, {});
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

TEST_CASE("the desk has a hand in it when a hand is there, and the same desk when it has gone",
          "[synth][gl]") {
  std::optional<DeskRenderer> renderer =
      renderer_of(scene_of({square({0, 0, 1}, 5.0, 0)}), 1, {0.0, 1.0, 0.2, 0.0});
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

TEST_CASE("shadows of what stands and of what moves fall on the desk's top, and on what moves",
          "[synth][gl]") {
  // Seen from a metre above the desk. A roof of 12 cm is 30 cm from a ball towards the sun.
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

  // The mean luma round a point's picture.
  const auto seen = [&](const ColorImage& image, const Eigen::Vector3d& x) {
    const Eigen::Vector2d at = eye.project(camera_from_desk * x);
    double sum = 0.0;
    for (int v = -3; v <= 3; ++v)
      for (int u = -3; u <= 3; ++u)
        sum += luma(image(static_cast<int>(at.x()) + u, static_cast<int>(at.y()) + v)) / 49.0;
    return sum;
  };
  const auto draw = [&](const std::vector<PaintedMesh>& meshes) {
    std::optional<DeskRenderer> renderer = renderer_of(scene_of(meshes), 1, {0.0, 1.0, 0.0, 0.0});
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
  // Light of the room alone against the sun's besides: 0.5 to 1.4.
  constexpr double kShaded = 0.75;
  CHECK(seen(open.left, under_ball) < kShaded * seen(open.left, beside));
  CHECK(seen(open.left, under_roof) > 0.95 * seen(open.left, beside));
  CHECK(seen(roofed.left, under_roof) < kShaded * seen(open.left, under_roof));
  CHECK(seen(roofed.left, beside) > 0.95 * seen(open.left, beside));
  CHECK(seen(roofed.left, top_of_ball) < kShaded * seen(open.left, top_of_ball));
}

TEST_CASE("labels say what moves and what the right eye sees too", "[synth][gl]") {
  // A wall at 1 m and a ball before it: the wall left of the ball is hidden from the right eye.
  std::optional<DeskRenderer> renderer = renderer_of(scene_of({square({0, 0, 1}, 5.0, 0)}), 1, {});
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
      // Within a pixel of a border either answer is right.
      const double beside = std::min(signed_distance(shapes, right_eye + 0.4 / ray.z() * ray),
                                     signed_distance(shapes, 0.4 / z * point));
      if (both != truly && std::abs(beside) > 0.006 && u > 1.0 && u < view.width - 2.0) ++wrong;
    }
  CHECK(moving > 1000);
  CHECK(hidden > 1000);
  CHECK(wrong == 0);
}

TEST_CASE("an exposure smears a turning camera's picture by the angle it turns", "[synth][gl]") {
  std::vector<PaintedMesh> squares = {square({0, 0, 1.0}, 0.015, 1)};
  std::optional<DeskRenderer> renderer = renderer_of(scene_of(squares), 1, {0.0, 1.0, 0.0, 0.0});
  if (!renderer) PALPABLE_SKIP(kNoGl);
  constexpr double kRate = 0.02;  // rad a frame
  DeskMoment turning = still(3);
  turning.camera_from_desk = [](double frame) {
    return Rigid3(Eigen::AngleAxisd(kRate * (frame - 3.0), Eigen::Vector3d::UnitY()));
  };
  RawPair sharp, smeared;
  renderer->draw(turning, sharp);
  turning.rig.exposure = 0.5 / kFramesPerSecond;
  renderer->draw(turning, smeared);
  const Eigen::Vector2d at = zed_mini_rig().left.project({0, 0, 1.0});
  // Second moment along the row: a box of width w adds w^2 / 12.
  const auto spread = [&](const ColorImage& image) {
    double sum = 0, first = 0, second = 0;
    const auto v = static_cast<int>(std::lround(at.y()));
    for (int y = v - 12; y <= v + 12; ++y)
      for (int x = static_cast<int>(at.x()) - 30; x <= static_cast<int>(at.x()) + 30; ++x) {
        const double light = std::pow(luma(image(x, y)) / 255.0, 2.0);
        sum += light;
        first += light * x;
        second += light * x * x;
      }
    return std::pair(first / sum, second / sum - first * first / (sum * sum));
  };
  const auto [middle_sharp, wide_sharp] = spread(sharp.left);
  const auto [middle_smeared, wide_smeared] = spread(smeared.left);
  const double width = 700.21 * kRate * 0.5;  // px
  CHECK(std::abs(middle_smeared - middle_sharp) <=
        tolerance(0.1, "the shutter is open round the moment"));
  CHECK(std::abs(wide_smeared - wide_sharp - width * width / 12.0) <=
        tolerance(0.8, "5 moments instead of all, of 4 px^2; grey levels are rounded"));
}

TEST_CASE("an exposure is the mean of its moments, camera and movers moving", "[synth][gl]") {
  std::vector<PaintedMesh> squares = {square({0, 0, 1.2}, 1.5, 0), square({0.1, 0.05, 1.0}, 0.2, 1),
                                      square({-0.15, 0, 0.5}, 0.06, 1)};
  std::optional<DeskRenderer> renderer = renderer_of(scene_of(squares), 1, {0.0, 1.0, 0.0, 0.0});
  if (!renderer) PALPABLE_SKIP(kNoGl);
  constexpr int kFrame = 3;
  // A ball that goes along with the camera moves by 3 px in the picture, another by 19 px and what
  // the camera does.
  struct Motion {
    double turn;   // rad a frame, 0.04: 14 px in half a frame
    double shift;  // m a frame, 0.008: 5 px at 0.5 m
    bool goes_along;
  };
  const Motion motion = GENERATE(Motion{0.0, 0.0, false}, Motion{0.04, 0.008, false},
                                 Motion{0.04, 0.0, false}, Motion{0.04, 0.008, true});
  INFO("turn " << motion.turn << ", shift " << motion.shift << ", along " << motion.goes_along);
  DeskMoment moving = still(kFrame);
  moving.camera_from_desk = [&](double frame) {
    const double along = frame - kFrame;
    return Rigid3(Eigen::Translation3d(motion.shift * along, 0, 0) *
                  Eigen::AngleAxisd(motion.turn * along, Eigen::Vector3d(0, 1, 0.2).normalized()));
  };
  moving.movers = [&](double frame) {
    HandCapsule ball;
    const double along = (motion.goes_along ? 0.16 : 1.0) * (frame - kFrame);
    const Rigid3 desk_from_own =
        motion.goes_along ? moving.camera_from_desk(frame).inverse() : Rigid3::Identity();
    const Eigen::Vector3d at(0.02 + 0.016 * along, 0.01 * along, 0.3);
    ball.shape = {desk_from_own * at, desk_from_own * (at + Eigen::Vector3d(0, 0.03, 0)), 0.03,
                  0.02};
    return Movers{{ball}, std::nullopt};
  };
  RawPair smeared, sharp;
  renderer->draw(moving, sharp);
  moving.rig.exposure = 0.5 / kFramesPerSecond;
  renderer->draw(moving, smeared);
  // Light of 24 moments, each drawn as a frame of its own.
  constexpr int kMoments = 24;
  const auto size = static_cast<std::size_t>(sharp.left.width() * sharp.left.height());
  std::vector<double> left(size, 0.0), right(size, 0.0);
  const auto light = [](const Rgb& c) { return std::pow(luma(c) / 255.0, 2.0); };
  for (int i = 0; i < kMoments; ++i) {
    const double at = kFrame + 0.5 * ((i + 0.5) / kMoments - 0.5);
    RawPair one;
    renderer->draw({kFrame, [&](double) { return moving.camera_from_desk(at); },
                    [&](double) { return moving.movers(at); }, RigState{}},
                   one);
    for (std::size_t k = 0; k < size; ++k) {
      left[k] += light(one.left.data()[k]) / kMoments;
      right[k] += light(one.right.data()[k]) / kMoments;
    }
  }
  // Where motion changes the picture by more than rounding: mean errors of both pictures, levels.
  const auto errors = [&](const ColorImage& plain, const ColorImage& image,
                          const std::vector<double>& mean) {
    double unsmeared = 0, error = 0;
    int changed = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const double level = 255.0 * std::sqrt(mean[k]);
      if (std::abs(luma(plain.data()[k]) - level) < 4.0) continue;
      unsmeared += std::abs(luma(plain.data()[k]) - level);
      error += std::abs(luma(image.data()[k]) - level);
      ++changed;
    }
    CHECK(changed > 2000);
    return std::pair(unsmeared / changed, error / changed);
  };
  for (const auto& [unsmeared, error] :
       {errors(sharp.left, smeared.left, left), errors(sharp.right, smeared.right, right)}) {
    // A camera that only turns has one reference, whose edges lie in whole pixels.
    const double share = motion.turn > 0.0 && motion.shift == 0.0 ? 0.15 : 0.13;
    CHECK(error <= tolerance(share * unsmeared,
                             "edges go in steps of up to 4 px instead of one; the shadow is the "
                             "middle one's"));
  }
}

TEST_CASE("a thing that appears while the shutter is open is not blended with nothing",
          "[synth][gl]") {
  std::optional<DeskRenderer> renderer =
      renderer_of(scene_of({square({0, 0, 1}, 5.0, 0)}), 1, {0.0, 1.0, 0.0, 0.0});
  if (!renderer) PALPABLE_SKIP(kNoGl);
  constexpr int kFrame = 3;
  DeskMoment turning = still(kFrame);
  turning.rig.exposure = 0.5 / kFramesPerSecond;
  turning.camera_from_desk = [](double frame) {
    return Rigid3(Eigen::AngleAxisd(0.02 * (frame - kFrame), Eigen::Vector3d::UnitY()));
  };
  // One ball moves by 20 px; another is there from a moment on.
  double since = 0;
  const auto balls = [&](double frame) {
    HandCapsule ball;
    ball.shape.a = {0.03 * (frame - kFrame) - 0.1, 0, 0.5};
    ball.shape.b = ball.shape.a + Eigen::Vector3d(0, 0.01, 0);
    ball.shape.ra = ball.shape.rb = 0.02;
    Movers movers{{ball}, std::nullopt};
    ball.shape.a = {0.1, 0, 0.5};
    ball.shape.b = {0.1, 0.01, 0.5};
    if (frame >= since) movers.capsules.push_back(ball);
    return movers;
  };
  for (const double moment : {kFrame - 0.1, kFrame + 0.1}) {
    INFO("it appears at " << moment);
    since = moment;
    RawPair appearing, standing, moving;
    turning.movers = balls;
    renderer->draw(turning, appearing);
    turning.movers = [&](double /*frame*/) { return balls(kFrame); };
    renderer->draw(turning, standing);
    CHECK(appearing.left == standing.left);
    CHECK(appearing.right == standing.right);
    since = 0;  // the same without anything that appears: it moves
    turning.movers = balls;
    renderer->draw(turning, moving);
    CHECK(moving.left != standing.left);
  }
}

TEST_CASE("a rolling shutter reads each row at its own moment", "[synth][gl]") {
  std::vector<PaintedMesh> squares;
  std::vector<Eigen::Vector3d> points;
  for (const double y : {-0.40, -0.22, 0.0, 0.20, 0.38}) {
    points.emplace_back(0.05, y, 1.0);
    squares.push_back(square(points.back(), 0.015, 1));
  }
  std::optional<DeskRenderer> renderer = renderer_of(scene_of(squares), 1, {0.0, 1.0, 0.0, 0.0});
  if (!renderer) PALPABLE_SKIP(kNoGl);
  constexpr double kRate = 0.01;  // rad a frame
  const auto pose = [](double frame) {
    return Rigid3(Eigen::AngleAxisd(kRate * (frame - 3.0), Eigen::Vector3d::UnitY()));
  };
  DeskMoment turning = still(3);
  turning.camera_from_desk = pose;
  turning.rig.readout = 0.9 / kFramesPerSecond;
  RawPair pair;
  renderer->draw(turning, pair);
  const DistortedCamera& left = zed_mini_rig().left;
  for (const Eigen::Vector3d& point : points) {
    INFO("point " << point.transpose());
    // Where the picture of the point is read: its row's moment, found by going round twice.
    Eigen::Vector2d at = left.project(point);
    for (int i = 0; i < 4; ++i) at = left.project(pose(3.0 + 0.9 * (at.y() / 719.0 - 0.5)) * point);
    CHECK((bright_spot(pair.left, at) - at).norm() <= tolerance(0.2, "as without readout: 0.1 px"));
  }
}

TEST_CASE("a right image that sinks lies lower by so many rows", "[synth][gl]") {
  std::optional<DeskRenderer> renderer =
      renderer_of(scene_of({square({0, 0.1, 0.8}, 0.015, 1)}), 1, {0.0, 1.0, 0.0, 0.0});
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

TEST_CASE("half of the light is half of the light", "[synth][gl]") {
  std::optional<DeskRenderer> renderer =
      renderer_of(scene_of({square({0, 0, 1}, 5.0, 0)}), 1, {0.0, 1.0, 0.0, 0.0});
  if (!renderer) PALPABLE_SKIP(kNoGl);
  DeskMoment moment = still(0);
  RawPair full, half;
  renderer->draw(moment, full);
  moment.rig.light = 0.5;
  renderer->draw(moment, half);
  CHECK(std::abs(luma(half.left(640, 360)) / luma(full.left(640, 360)) - std::sqrt(0.5)) <=
        tolerance(0.01, "rounded to grey levels"));
}
