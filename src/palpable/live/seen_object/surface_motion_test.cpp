#include "palpable/live/seen_object/surface_motion.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3f;
using test::tolerance;

constexpr double kFrame = 1.0 / 30;  // s
// The extrapolated displacement after half a frame, as a ratio to that of the last frame.
const float kHalfway = 1 - std::exp(-0.5f);
constexpr float kRadius = 0.008f;    // m
const Vector3f kCamera(0, 0, 0.4f);  // m, above

// Adds a finger that extends from its tip in the direction `along`, seen from above.
void add_finger(std::vector<ObjectBall>& balls, const Vector3f& tip, const Vector3f& along) {
  for (float s = 0; s < 0.06f; s += 0.001f) {
    const Vector3f centre = tip + (s + kRadius) * along;
    balls.push_back({centre + Vector3f(0, 0, kRadius), Vector3f::UnitZ(), centre, kRadius, 2e-4f});
  }
}

std::vector<ObjectBall> finger_at(const Vector3f& tip) {
  std::vector<ObjectBall> balls;
  add_finger(balls, tip, Vector3f::UnitX());
  return balls;
}

// The velocity (m/s) of the ball at the tip of a finger that moved by `way` in each frame.
Vector3f velocity_after(int frames, const Vector3f& way) {
  SurfaceMotion motion;
  for (int n = 0; n < frames; ++n) {
    motion.add(finger_at(static_cast<float>(n) * way), kCamera, n * kFrame);
  }
  return motion.velocities().front();
}

TEST_CASE("a finger's tip gets the velocity of the finger, in every direction",
          "[seen_object][motion]") {
  for (const Vector3f& way :
       {Vector3f(0, 0, -0.001f), Vector3f(0, 0.003f, 0), Vector3f(-0.002f, 0, 0),
        Vector3f(0.001f, -0.002f, 0.003f), Vector3f(0, 0, -0.007f)}) {
    INFO("way " << way.transpose());
    const Vector3f expected = way / static_cast<float>(kFrame);
    CHECK((velocity_after(5, way) - expected).norm() <
          tolerance(0.06f, "of it: regularisation, bumps") * expected.norm());
  }
}

TEST_CASE("the extrapolated surface meets the surface seen next", "[seen_object][motion]") {
  const Vector3f way(0.0005f, 0.001f, -0.0015f);
  SurfaceMotion motion;
  for (int n = 0; n < 6; ++n) {
    motion.add(finger_at(static_cast<float>(n) * way), kCamera, n * kFrame);
  }
  CHECK(motion.interval() == Approx(kFrame));
  std::vector<ObjectBall> carried;
  motion.carry(kFrame / 2, carried);
  const std::vector<ObjectBall> expected = finger_at((5 + kHalfway) * way);
  REQUIRE(carried.size() == expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    CHECK((carried[k].centre - expected[k].centre).norm() < tolerance(1e-4f, "m: 6 % of that"));
    CHECK((carried[k].point - carried[k].centre - (expected[k].point - expected[k].centre)).norm() <
          1e-6f);
    CHECK(carried[k].radius == expected[k].radius);
  }
}

TEST_CASE("two things near each other move each by itself", "[seen_object][motion]") {
  SurfaceMotion motion;
  std::vector<ObjectBall> balls;
  for (int n = 0; n < 6; ++n) {
    balls.clear();
    const float on = 0.001f * static_cast<float>(n);
    add_finger(balls, {0.03f + on, 0, 0}, Vector3f::UnitX());
    add_finger(balls, {-0.03f, 0, -on}, -Vector3f::UnitX());
    motion.add(balls, kCamera, n * kFrame);
  }
  const std::size_t half = balls.size() / 2;
  CHECK((motion.velocities()[0] - Vector3f(0.03f, 0, 0)).norm() < tolerance(0.004f, "m/s: 13 %"));
  CHECK((motion.velocities()[half] - Vector3f(0, 0, -0.03f)).norm() < tolerance(0.004f, "m/s"));
}

TEST_CASE("a resting thing is extrapolated by less than its measurements scatter",
          "[seen_object][motion]") {
  std::mt19937 random(1);
  std::normal_distribution<float> scatter(0, 2e-4f);
  SurfaceMotion motion;
  double squares = 0;
  for (int n = 0; n < 60; ++n) {
    motion.add(finger_at({scatter(random), scatter(random), scatter(random)}), kCamera, n * kFrame);
    squares += static_cast<double>(motion.velocities().front().squaredNorm()) * kFrame * kFrame;
  }
  // The rms difference of two frames is sqrt(2) * sqrt(3) * 0.2 mm.
  CHECK(std::sqrt(squares / 60) < tolerance(4.9e-4, "m: what two frames differ by"));
}

TEST_CASE("only things that were seen moving have a velocity", "[seen_object][motion]") {
  SurfaceMotion motion;
  const auto fastest = [&] {
    float most = 0;
    for (const Vector3f& v : motion.velocities()) most = std::max(most, v.norm());
    return most;
  };
  motion.add(finger_at({0, 0, 0}), kCamera, 0);
  CHECK(fastest() == 0);  // the first frame
  SurfaceMotion late;
  late.add(finger_at({0, 0, 0}), kCamera, 0.1);
  CHECK(late.interval() == 0);
  std::vector<ObjectBall> held = finger_at({0, 0, 0.002f});
  for (ObjectBall& ball : held) ball.unseen_for = 0.1f;
  motion.add(held, kCamera, kFrame);
  CHECK(fastest() == 0);  // it is not seen
  motion.add(finger_at({0, 0, 0.004f}), kCamera, 2 * kFrame);
  CHECK(fastest() == 0);  // it was not seen in the frame before
  motion.add(finger_at({0.1f, 0.1f, 0.1f}), kCamera, 3 * kFrame);
  CHECK(fastest() == 0);  // another thing
  motion.add(finger_at({0.1f, 0.1f, 0.102f}), kCamera, 5);
  CHECK(fastest() == 0);  // long after
  CHECK(motion.interval() == 0);
  motion.add(finger_at({0.1f, 0.1f, 0.104f}), kCamera, std::numeric_limits<double>::quiet_NaN());
  CHECK(fastest() == 0);
  motion.add({}, kCamera, 5.1);
  CHECK(motion.velocities().empty());
  CHECK_THROWS_AS(SurfaceMotion({.around = 0}), ContractViolation);
}

TEST_CASE("following a moving surface allocates nothing", "[seen_object][motion]") {
  SurfaceMotion motion;
  std::vector<std::vector<ObjectBall>> frames;
  for (int n = 0; n < 5; ++n) frames.push_back(finger_at({0, 0, -0.001f * static_cast<float>(n)}));
  std::vector<ObjectBall> carried;
  carried.reserve(frames[0].size());
  CHECK(test::allocations_during([&] {
          for (int n = 0; n < 5; ++n) {
            motion.add(frames[static_cast<std::size_t>(n)], kCamera, n * kFrame);
            motion.carry(0.01, carried);
          }
        }) == 0);
}

}  // namespace
}  // namespace palpable
