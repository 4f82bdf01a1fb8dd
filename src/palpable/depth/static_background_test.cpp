#include "palpable/depth/static_background.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <random>

namespace palpable {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 40;
const float kNaN = std::nanf("");

// Half resolution of a 720p rig: f = 350 px, T = 63 mm.
DepthNoise rig_noise() { return stereo_noise({{kWidth, kHeight, 350, 350, 31.5, 19.5}, 0.063, 0}); }

int known(const DepthImage& depth) {
  int count = 0;
  for (const float Z : depth) count += std::isnan(Z) ? 0 : 1;
  return count;
}

// A desk that goes away from 0.35 to 0.8 m, seen with the noise of the model.
DepthImage noisy_desk(std::mt19937_64& random, const DepthNoise& noise) {
  std::normal_distribution<double> normal;
  DepthImage depth(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    const double Z = 0.8 - 0.45 * y / (kHeight - 1);
    for (int x = 0; x < kWidth; ++x) {
      depth(x, y) = static_cast<float>(Z + noise.sigma(Z) * normal(random));
    }
  }
  return depth;
}

StaticBackground learnt(std::mt19937_64& random, StaticBackgroundSettings settings = {}) {
  StaticBackground background(rig_noise(), settings);
  while (!background.ready()) background.learn(noisy_desk(random, rig_noise()));
  return background;
}

TEST_CASE("a desk that was there is gone, near and far alike", "[depth][static_background]") {
  auto random = test::random_case(1);
  // With no window, so that nothing but the tolerance keeps the noise out.
  const StaticBackground background = learnt(random, {.edge_window_px = 0});
  int left = 0;
  constexpr int kFrames = 50;
  for (int frame = 0; frame < kFrames; ++frame) {
    DepthImage depth = noisy_desk(random, rig_noise());
    background.remove_static(depth);
    left += known(depth);
  }
  CHECK(left <= test::tolerance(1e-4,
                                "one side beyond 4 sigma is 3e-5 of a normal distribution; "
                                "the median's own noise widens it") *
                    kFrames * kWidth * kHeight);
}

TEST_CASE("a hand above the desk is kept whole, and its depth untouched",
          "[depth][static_background]") {
  auto random = test::random_case(2);
  const StaticBackground background = learnt(random);
  DepthImage depth = noisy_desk(random, rig_noise());
  for (int y = 10; y < 20; ++y) {
    for (int x = 20; x < 40; ++x) depth(x, y) = 0.45F;  // the desk is at 0.58 m or more there
  }
  background.remove_static(depth);
  CHECK(known(depth) == 10 * 20);
  CHECK(depth(25, 15) == 0.45F);
}

TEST_CASE("what counts as the desk grows with the square of the depth for stereo",
          "[depth][static_background]") {
  const DepthNoise noise = rig_noise();
  const auto thickness = [&](float Z) {
    StaticBackground background(noise, {.frames = 1, .sigmas = 4, .edge_window_px = 0});
    background.learn(DepthImage(1, 1, Z));
    float above = 0;
    for (;; above += 1e-5F) {
      DepthImage depth(1, 1, Z - above);
      background.remove_static(depth);
      if (known(depth) == 1) return above;
    }
  };
  const float near = thickness(0.4F);
  // 4 sigma = 4 * 0.4^2 / (350 * 0.063) * 0.25
  CHECK(std::abs(near - 0.007256F) <= test::tolerance(2e-5, "the search's step is 1e-5 m"));
  CHECK(std::abs(thickness(0.8F) - 4 * near) <=
        test::tolerance(1e-4, "steps of 1e-5 m, four-fold"));
}

TEST_CASE("a pixel that scatters more than the sensor should is given more room",
          "[depth][static_background]") {
  auto random = test::random_case(4);
  const DepthNoise noise = rig_noise();
  const auto left_over = [&](double times) {
    std::normal_distribution<double> scatter(0, times * noise.sigma(0.5));
    const auto image = [&] {
      DepthImage depth(kWidth, kHeight);
      for (float& Z : depth) Z = static_cast<float>(0.5 + scatter(random));
      return depth;
    };
    StaticBackground background(noise, {.edge_window_px = 1});
    while (!background.ready()) background.learn(image());
    DepthImage depth = image();
    background.remove_static(depth);
    return static_cast<double>(known(depth)) / (kWidth * kHeight);
  };
  // At 4 times the sensor's sigma a fixed limit of 4 sigma would let 16 % through.
  CHECK(left_over(2) <= 1e-3);
  CHECK(left_over(4) <= 0.01);
}

TEST_CASE("a depth edge that flickers by two pixels does not come through",
          "[depth][static_background]") {
  auto random = test::random_case(3);
  std::uniform_int_distribution<int> flicker(-1, 1);
  const auto box_on_desk = [&] {
    DepthImage depth(kWidth, kHeight, 0.6F);
    for (int y = 0; y < kHeight; ++y) {
      const int edge = 30 + flicker(random);
      for (int x = 0; x < edge; ++x) depth(x, y) = 0.4F;
    }
    return depth;
  };
  const auto left_over = [&](int window) {
    StaticBackground background(rig_noise(), {.edge_window_px = window});
    while (!background.ready()) background.learn(box_on_desk());
    int left = 0;
    for (int frame = 0; frame < 20; ++frame) {
      DepthImage depth = box_on_desk();
      background.remove_static(depth);
      left += known(depth);
    }
    return left;
  };
  CHECK(left_over(2) == 0);
  CHECK(left_over(0) > 0);  // the window is what does it
}

TEST_CASE("where nothing was known, what comes is new", "[depth][static_background]") {
  DepthImage desk(kWidth, kHeight, 0.5F);
  for (int y = 10; y < 30; ++y) {
    for (int x = 10; x < 30; ++x) desk(x, y) = kNaN;
  }
  StaticBackground background(rig_noise());
  while (!background.ready()) background.learn(desk);
  DepthImage depth(kWidth, kHeight, 0.5F);
  background.remove_static(depth);
  // The window of 2 px reaches into the hole from all sides.
  CHECK(known(depth) == 16 * 16);
  CHECK(depth(20, 20) == 0.5F);
}

TEST_CASE("what lies behind the background, or is unknown, is not new",
          "[depth][static_background]") {
  StaticBackground background(rig_noise());
  while (!background.ready()) background.learn(DepthImage(kWidth, kHeight, 0.5F));
  DepthImage behind(kWidth, kHeight, 0.9F);
  background.remove_static(behind);
  CHECK(known(behind) == 0);
  DepthImage unknown(kWidth, kHeight, kNaN);
  background.remove_static(unknown);
  CHECK(known(unknown) == 0);
}

TEST_CASE("a passer-by in a few of the first frames is not learnt", "[depth][static_background]") {
  StaticBackground background(rig_noise());
  for (int frame = 0; frame < 15; ++frame) {
    background.learn(DepthImage(kWidth, kHeight, frame < 5 ? 0.3F : 0.6F));
  }
  CHECK(background.depth()(3, 4) == 0.6F);
  DepthImage hand(kWidth, kHeight, 0.35F);
  background.remove_static(hand);
  CHECK(known(hand) == kWidth * kHeight);
}

TEST_CASE("the background is learnt once, and used only then", "[depth][static_background]") {
  StaticBackground background(rig_noise(), {.frames = 2});
  DepthImage depth(kWidth, kHeight, 0.5F);
  CHECK_THROWS_AS(background.remove_static(depth), ContractViolation);
  background.learn(depth);
  CHECK_FALSE(background.ready());
  CHECK_THROWS_AS(background.learn(DepthImage(3, 3, 0.5F)), ContractViolation);
  background.learn(depth);
  CHECK(background.ready());
  background.learn(DepthImage(kWidth, kHeight, 0.1F));  // too late: changes nothing
  CHECK(background.depth()(0, 0) == 0.5F);
  DepthImage other(kWidth + 1, kHeight, 0.5F);
  CHECK_THROWS_AS(background.remove_static(other), ContractViolation);
  CHECK(test::allocations_during([&] { background.remove_static(depth); }) == 0);
  CHECK_THROWS_AS(StaticBackground(rig_noise(), {.frames = 0}), ContractViolation);
}

TEST_CASE("a camera that has moved still sees the desk as what was there, and a hand as new",
          "[depth][static_background]") {
  // A wall at 1 m, learnt without noise; then the camera is 0.1 m nearer and turned by 3 degrees.
  const PinholeCamera camera{kWidth, kHeight, 60, 60, 31.5, 19.5};
  StaticBackground background(rig_noise(), {.frames = 3});
  for (int i = 0; i < 3; ++i) background.learn(DepthImage(kWidth, kHeight, 1));
  Rigid3 now_from_learnt = Rigid3::Identity();
  now_from_learnt.linear() = Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitY()).toRotationMatrix();
  now_from_learnt.translation() = Eigen::Vector3d(0.02, 0, -0.1);
  const Eigen::Vector3d normal = now_from_learnt.linear() * Eigen::Vector3d::UnitZ();
  const double distance = 1 + normal.dot(now_from_learnt.translation());
  DepthImage depth(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      depth(x, y) = static_cast<float>(distance / normal.dot(camera.unproject(x, y, 1)));
    }
  }
  for (int y = 10; y < 20; ++y) {
    for (int x = 20; x < 30; ++x) depth(x, y) = 0.5F;  // a hand
  }
  DepthImage as_if_still = depth;
  background.remove_static(depth, camera, now_from_learnt);
  CHECK(known(depth) == 100);
  CHECK(depth(25, 15) == 0.5F);
  // Without the motion the nearer wall would be new nearly everywhere.
  background.remove_static(as_if_still);
  CHECK(known(as_if_still) > kWidth * kHeight / 2);
}

TEST_CASE("before what never had a depth everything is new, also for a camera that has moved",
          "[depth][static_background]") {
  const PinholeCamera camera{kWidth, kHeight, 60, 60, 31.5, 19.5};
  StaticBackground background(rig_noise(), {.frames = 3});
  DepthImage half(kWidth, kHeight, 1);  // the left half is a wall, the right half a blank one
  for (int y = 0; y < kHeight; ++y) {
    for (int x = kWidth / 2; x < kWidth; ++x) half(x, y) = std::numeric_limits<float>::quiet_NaN();
  }
  for (int i = 0; i < 3; ++i) background.learn(half);
  Rigid3 now_from_learnt = Rigid3::Identity();
  now_from_learnt.translation() = Eigen::Vector3d(0.002, 0, 0);
  DepthImage depth(kWidth, kHeight, 1);
  for (int y = 10; y < 20; ++y) {
    for (int x = 50; x < 60; ++x) depth(x, y) = 0.5F;  // a hand before the blank half
  }
  background.remove_static(depth, camera, now_from_learnt);
  CHECK(depth(55, 15) == 0.5F);
  CHECK(std::isnan(depth(10, 15)));
}

}  // namespace
}  // namespace palpable
