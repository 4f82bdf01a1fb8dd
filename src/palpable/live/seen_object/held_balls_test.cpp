#include "palpable/live/seen_object/held_balls.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <limits>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3f;
using test::tolerance;

constexpr PinholeCamera kCamera{161, 121, 350, 350, 80, 60};
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr double kFrame = 1.0 / 30;  // s

// A row of balls across the view at 0.4 m, their fronts at 0.39 m.
std::vector<ObjectBall> finger() {
  std::vector<ObjectBall> balls;
  for (int i = -10; i <= 10; ++i) {
    const Vector3f centre(0.002f * static_cast<float>(i), 0, 0.4f);
    balls.push_back({centre - Vector3f(0, 0, 0.01f), {0, 0, -1}, centre, 0.01f, 0.001f});
  }
  return balls;
}

struct Held {
  // Adds a frame in which nothing of the finger is measured, and all pixels show `what` at depth z.
  const std::vector<ObjectBall>& show(std::uint8_t what, float z = kNone) {
    const DepthImage depth(kCamera.width, kCamera.height, z);
    const MaskImage shows(kCamera.width, kCamera.height, what);
    balls.clear();
    held.recall(depth, shows, kCamera, Rigid3::Identity(), time, balls);
    time += kFrame;
    return balls;
  }
  void show_finger() {
    const DepthImage depth(kCamera.width, kCamera.height, 0.39f);
    const MaskImage shows(kCamera.width, kCamera.height, kShowsPresser);
    balls = finger();
    held.recall(depth, shows, kCamera, Rigid3::Identity(), time, balls);
    time += kFrame;
  }

  HeldBalls held;
  std::vector<ObjectBall> balls;
  double time = 0;
};

TEST_CASE("balls of which nothing is known are held unchanged for 0.3 s, then they fade",
          "[seen_object][held]") {
  Held scene;
  scene.show_finger();
  REQUIRE(scene.balls.size() == 21);
  float before = 0.01f;
  for (int frame = 1; frame <= 30; ++frame) {
    INFO("frame " << frame);
    const auto& balls = scene.show(kShowsUnknown);
    const double unseen = frame * kFrame;
    if (unseen >= 0.6 - 1e-6) {
      CHECK(balls.empty());
      continue;
    }
    REQUIRE(balls.size() == 21);
    CHECK(balls[3].centre == finger()[3].centre);
    CHECK(balls[3].unseen_for == Approx(unseen).margin(tolerance(1e-6, "a sum of floats")));
    if (unseen <= 0.3) {
      CHECK(balls[3].radius == 0.01f);
    } else {
      CHECK(balls[3].radius < before);
      CHECK(balls[3].radius == Approx(0.01 * (0.6 - unseen) / 0.3).margin(1e-6));
    }
    before = balls[3].radius;
  }
}

TEST_CASE("what was seen through is released at once, and stays so", "[seen_object][held]") {
  Held scene;
  scene.show_finger();
  CHECK(scene.show(kShowsRoom, 0.8f).empty());
  CHECK(scene.show(kShowsUnknown).empty());

  // Also after the balls were held for a while.
  scene.show_finger();
  REQUIRE(scene.show(kShowsUnknown).size() == 21);
  CHECK(scene.show(kShowsRoom, 0.8f).empty());
  // A pixel can show the room without a depth, because it looks as the room did.
  scene.show_finger();
  CHECK(scene.show(kShowsRoom).empty());
}

TEST_CASE("what something nearer hides is held", "[seen_object][held]") {
  Held scene;
  scene.show_finger();
  CHECK(scene.show(kShowsRoom, 0.3f).size() == 21);
}

TEST_CASE("where a thing that presses is measured now, nothing older is held",
          "[seen_object][held]") {
  Held scene;
  scene.show_finger();
  CHECK(scene.show(kShowsPresser, 0.5f).empty());
}

TEST_CASE("nothing is held of a thing that is still seen: it may have moved",
          "[seen_object][held]") {
  Held scene;
  scene.show_finger();
  const DepthImage depth(kCamera.width, kCamera.height, kNone);
  const MaskImage shows(kCamera.width, kCamera.height, kShowsUnknown);
  std::vector<ObjectBall> balls = finger();
  balls.resize(15);
  scene.held.recall(depth, shows, kCamera, Rigid3::Identity(), scene.time, balls);
  CHECK(balls.size() == 15);
  // When fewer than half of the balls are left, the thing has vanished.
  balls.resize(5);
  scene.held.recall(depth, shows, kCamera, Rigid3::Identity(), scene.time + kFrame, balls);
  CHECK(balls.size() == 20);
}

TEST_CASE("what left the picture is held, and holding allocates nothing", "[seen_object][held]") {
  Held scene;
  scene.show_finger();
  DepthImage depth(kCamera.width, kCamera.height, 0.8f);
  MaskImage shows(kCamera.width, kCamera.height, kShowsRoom);
  Rigid3 turned = Rigid3::Identity();
  turned.translation().x() = 0.5;
  std::vector<ObjectBall> balls;
  balls.reserve(21);
  CHECK(test::allocations_during(
            [&] { scene.held.recall(depth, shows, kCamera, turned, scene.time, balls); }) == 0);
  CHECK(balls.size() == 21);
}

TEST_CASE("holding refuses times that make no sense", "[seen_object][errors]") {
  CHECK_THROWS_AS(HeldBalls({.hold = -1}), ContractViolation);
  CHECK_THROWS_AS(HeldBalls({.fade = 0}), ContractViolation);
}

}  // namespace
}  // namespace palpable
