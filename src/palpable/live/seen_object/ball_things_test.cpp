#include "palpable/live/seen_object/ball_things.h"

#include "tests/support/test.h"

#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3f;
using test::tolerance;

// A finger along x that begins at `tip`, with a ball every `spacing`, m.
void add_finger_at(const Vector3f& tip, float spacing, std::vector<ObjectBall>& balls) {
  for (float s = 0; s < 0.05f; s += spacing) {
    ObjectBall ball;
    ball.centre = tip + s * Vector3f::UnitX();
    ball.normal = Vector3f::UnitZ();
    ball.point = ball.centre + ball.radius * ball.normal;
    balls.push_back(ball);
  }
}

TEST_CASE("balls that overlap are one thing, those apart are several", "[seen_object][friction]") {
  std::vector<ObjectBall> balls;
  add_finger_at({0, 0, 0}, 0.001f, balls);
  const std::size_t first = balls.size();
  add_finger_at({0, 0.030f, 0}, 0.001f, balls);  // 14 mm between them
  BallThings things;
  things.find(balls);
  REQUIRE(things.count() == 2);
  REQUIRE(things.of_balls().size() == balls.size());
  for (std::size_t k = 0; k < balls.size(); ++k) {
    CHECK(things.of_balls()[k] == (k < first ? 0 : 1));
  }
  CHECK((things.centres()[1] - things.centres()[0] - Vector3f(0, 0.030f, 0)).norm() <
        tolerance(1e-6f, "rounding"));

  add_finger_at({0, 0.015f, 0}, 0.001f, balls);  // joins them
  things.find(balls);
  CHECK(things.count() == 1);
  things.find({});
  CHECK(things.count() == 0);
  CHECK(things.of_balls().empty());
}

TEST_CASE("things of more balls than are compared are told apart, too", "[seen_object][friction]") {
  std::vector<ObjectBall> balls;
  for (int k = 0; k < 8; ++k) {
    add_finger_at({0, 0.004f * static_cast<float>(k), 0}, 0.0005f, balls);
  }
  const std::size_t first = balls.size();
  REQUIRE(first > 512);
  add_finger_at({0, 0.060f, 0}, 0.0005f, balls);
  BallThings things;
  things.find(balls);
  REQUIRE(things.count() == 2);
  for (std::size_t k = 0; k < balls.size(); ++k) {
    REQUIRE(things.of_balls()[k] == (k < first ? 0 : 1));
  }
}

}  // namespace
}  // namespace palpable
