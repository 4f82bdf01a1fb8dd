// Pictures with motion during a frame: motion blur and the rolling shutter.

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

TEST_CASE("an exposure smears a turning camera's picture by the angle it turns", "[film][gl]") {
  std::vector<PaintedMesh> squares = {square({0, 0, 1.0}, 0.015, 1)};
  std::optional<DeskRenderer> renderer = renderer_of(scene_of(squares), 1, kFaultless);
  if (!renderer) PALPABLE_SKIP(kNoGl);
  constexpr double kRate = 0.02;  // rad per frame
  DeskMoment turning = still(3);
  turning.camera_from_desk = [](double frame) {
    return Rigid3(Eigen::AngleAxisd(kRate * (frame - 3.0), Eigen::Vector3d::UnitY()));
  };
  RawPair sharp, smeared;
  renderer->draw(turning, sharp);
  turning.rig.exposure = 0.5 / kFramesPerSecond;
  renderer->draw(turning, smeared);
  const Eigen::Vector2d at = zed_mini_rig().left.project({0, 0, 1.0});
  // The second moment along the row; a box filter of width w adds w^2 / 12.
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
        tolerance(0.1, "the exposure is centred at the frame's time"));
  CHECK(std::abs(wide_smeared - wide_sharp - width * width / 12.0) <=
        tolerance(0.8, "5 instants instead of all, of 4 px^2; grey levels are rounded"));
}

TEST_CASE("an exposure is the mean over its time, with moving camera and movers", "[film][gl]") {
  std::vector<PaintedMesh> squares = {square({0, 0, 1.2}, 1.5, 0), square({0.1, 0.05, 1.0}, 0.2, 1),
                                      square({-0.15, 0, 0.5}, 0.06, 1)};
  // The test case runs once for each motion; all runs use one renderer, which is never destroyed
  // (wall_renderer).
  static auto& renderer =
      *new std::optional<DeskRenderer>(renderer_of(scene_of(squares), 1, kFaultless));
  if (!renderer) PALPABLE_SKIP(kNoGl);
  constexpr int kFrame = 3;
  // A ball that moves along with the camera moves by 3 px in the picture; another one moves by 19
  // px in addition to the camera's motion.
  struct Motion {
    double turn;   // rad per frame; 0.04: 14 px in half a frame
    double shift;  // m per frame; 0.008: 5 px at 0.5 m
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
  // The mean light of 24 instants, each drawn as a frame of its own.
  constexpr int kMoments = 24;
  const std::size_t size = sharp.left.size();
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
  // The mean errors, in grey levels, of both pictures over the pixels that motion changes by more
  // than rounding.
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
    // A camera that only turns has one reference, whose edges lie at whole pixels.
    const double share = motion.turn > 0.0 && motion.shift == 0.0 ? 0.15 : 0.13;
    CHECK(error <= tolerance(share * unsmeared,
                             "edges move in steps of up to 4 px instead of one; the shadow is that "
                             "of the middle"));
  }
}

TEST_CASE("a thing that appears while the shutter is open is not blended with nothing",
          "[film][gl]") {
  DeskRenderer* renderer = wall_renderer(kFaultless);
  if (!renderer) PALPABLE_SKIP(kNoGl);
  constexpr int kFrame = 3;
  DeskMoment turning = still(kFrame);
  turning.rig.exposure = 0.5 / kFramesPerSecond;
  turning.camera_from_desk = [](double frame) {
    return Rigid3(Eigen::AngleAxisd(0.02 * (frame - kFrame), Eigen::Vector3d::UnitY()));
  };
  // One ball moves by 20 px; another one is present from the time `since` on.
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
    since = 0;  // nothing appears: the first ball is blurred
    turning.movers = balls;
    renderer->draw(turning, moving);
    CHECK(moving.left != standing.left);
  }
}

TEST_CASE("a rolling shutter reads each row at its own time", "[film][gl]") {
  std::vector<PaintedMesh> squares;
  std::vector<Eigen::Vector3d> points;
  for (const double y : {-0.40, -0.22, 0.0, 0.20, 0.38}) {
    points.emplace_back(0.05, y, 1.0);
    squares.push_back(square(points.back(), 0.015, 1));
  }
  std::optional<DeskRenderer> renderer = renderer_of(scene_of(squares), 1, kFaultless);
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
    // The position of the point at the time when its row is read, by fixed-point iteration.
    Eigen::Vector2d at = left.project(point);
    for (int i = 0; i < 4; ++i) at = left.project(pose(3.0 + 0.9 * (at.y() / 719.0 - 0.5)) * point);
    CHECK((bright_spot(pair.left, at) - at).norm() <= tolerance(0.2, "as without readout: 0.1 px"));
  }
}
