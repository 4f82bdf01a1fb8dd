#include "palpable/live/seen_object/ball_tree.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3f;
using test::tolerance;

std::vector<Ball> some_balls(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-0.05f, 0.05f), radius(0.003f, 0.012f);
  std::vector<Ball> balls;
  for (int k = 0; k < count; ++k) {
    balls.push_back({{place(random), place(random), place(random)}, radius(random)});
  }
  return balls;
}

TEST_CASE("the nearest ball is the one that a search of all balls finds",
          "[seen_object][ball tree]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-0.06f, 0.06f);
  for (const int count : {1, 2, 8, 9, 17, 40, 300}) {
    INFO(count << " balls");
    const std::vector<Ball> balls = some_balls(count);
    BallTree tree;
    tree.build(balls);
    for (int n = 0; n < 100; ++n) {
      const Vector3f x(place(random), place(random), place(random));
      float expected = std::numeric_limits<float>::infinity();
      for (const Ball& ball : balls) {
        expected = std::min(expected, (ball.centre - x).norm() - ball.radius);
      }
      const auto found = tree.nearest(x, 1);
      REQUIRE(found);
      CHECK(std::abs(found->distance - expected) < 1e-6f);
      const Ball& ball = balls[static_cast<std::size_t>(found->ball)];
      CHECK(std::abs((ball.centre - x).norm() - ball.radius - expected) < 1e-6f);
      CHECK_FALSE(tree.nearest(x, expected - 1e-6f).has_value());
      CHECK(tree.is_any_within(x, expected + 1e-6f));
      CHECK_FALSE(tree.is_any_within(x, expected - 1e-6f));
    }
  }
  BallTree none;
  none.build({});
  CHECK_FALSE(none.nearest(Vector3f::Zero(), 1).has_value());
  CHECK_FALSE(none.is_any_within(Vector3f::Zero(), 1));
}

TEST_CASE("distances around a position are those that a search of all balls finds",
          "[seen_object][ball tree]") {
  const std::vector<Ball> balls = some_balls(300);
  BallTree tree;
  tree.build(balls);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-0.06f, 0.06f), step(-1, 1);
  constexpr float kSpread = 0.004f;
  std::array<Vector3f, 8> places;
  for (int n = 0; n < 300; ++n) {
    const Vector3f x(place(random), place(random), place(random));
    const Vector3f across = Vector3f(step(random), step(random), step(random)).normalized();
    for (Vector3f& at : places) {
      const Vector3f way = Vector3f(step(random), step(random), step(random));
      at = x + kSpread * across.cross(way).normalized();
    }
    const auto nearest = tree.nearest(x, 1);
    REQUIRE(nearest);
    const auto found = tree.distances_around(x, across, kSpread, places, nearest->ball);
    for (std::size_t k = 0; k < 8; ++k) {
      float expected = std::numeric_limits<float>::infinity();
      for (const Ball& ball : balls) {
        expected = std::min(expected, (ball.centre - places[k]).norm() - ball.radius);
      }
      CHECK(std::abs(found[k] - expected) < 1e-6f);
    }
  }
  const int ball = tree.nearest(Vector3f::Zero(), 1)->ball;
  CHECK(test::allocations_during([&] {
          (void)tree.distances_around(Vector3f::Zero(), Vector3f::UnitZ(), kSpread, places, ball);
        }) == 0);
}

}  // namespace
}  // namespace palpable
