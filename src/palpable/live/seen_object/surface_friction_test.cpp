#include "palpable/live/seen_object/surface_friction.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::tolerance;

constexpr float kSigma = 0.0002f;  // m
constexpr double kRate = 30;       // 1/s
constexpr float kStep = 0.0005f;   // m in a frame, of things that move

// A row of balls along x as a camera above sees them, whose middle is at `middle`; their depth
// scatters by a standard deviation.
std::vector<ObjectBall> row_of_balls(const Vector3f& middle, std::mt19937_64* noise = nullptr) {
  std::normal_distribution<float> tremble(0, kSigma);
  std::vector<ObjectBall> balls;
  for (int k = 0; k < 9; ++k) {
    ObjectBall ball;
    ball.centre = Vector3f(0.004f * static_cast<float>(k - 4), 0, 0) + middle;
    if (noise != nullptr) ball.centre.z() += tremble(*noise);
    ball.radius = 0.008f;
    ball.normal = Vector3f::UnitZ();
    ball.point = ball.centre + ball.radius * ball.normal;
    ball.sigma = kSigma;
    balls.push_back(ball);
  }
  return balls;
}

struct SeenThings {
  ObjectSurface surface;
  SurfaceFriction friction;
  Eigen::AlignedBox3d region{Vector3d::Constant(-0.2), Vector3d::Constant(0.2)};
  double time = 0;  // s, of the next frame

  void see(const std::vector<ObjectBall>& balls) {
    const Vector3f camera(0, 0, 0.5f);
    surface.build(balls, region, camera);
    friction.add(surface, camera, time);
    time += 1 / kRate;
  }
  // The share of the ball nearest to a place.
  [[nodiscard]] float share_at(const Vector3f& place) const {
    return surface.balls()[static_cast<std::size_t>(surface.nearest(place)->ball)].friction_share;
  }
};

// A place on the side of the middle ball, carried along with what is seen.
struct CarriedPlace {
  MaterialPoint place{-1, Vector3f(0, 0.008f, 0)};

  void follow(const SeenThings& seen) {
    const auto carried = seen.surface.carried(place);
    REQUIRE(carried);
    place = *carried;
  }
  [[nodiscard]] Vector3f way() const { return place.place - Vector3f(0, 0.008f, 0); }
};

TEST_CASE("friction fades in over six frames, and is never switched", "[seen_object][friction]") {
  SeenThings seen;
  const std::vector<ObjectBall> row = row_of_balls(Vector3f::Zero());
  seen.see(row);
  CHECK(seen.surface.friction_share() == 0);  // it is not known yet how it moves
  for (int frame = 1; frame <= 7; ++frame) {
    seen.see(row);
    CHECK(seen.surface.friction_share() == Approx(std::min(frame, 6) / 6.0));
  }
  CHECK(seen.surface.largest_friction(0.6f) == 0.6f);
  // Not seen for a frame, and then again.
  seen.see({});
  seen.see(row);
  CHECK(seen.surface.friction_share() == Approx(1.0));
  // Held, as behind something: it fades out by a sixth in a frame, and in again.
  std::vector<ObjectBall> held = row;
  for (ObjectBall& ball : held) ball.unseen_for = 0.03f;
  seen.see(held);
  seen.see(held);
  CHECK(seen.surface.friction_share() == Approx(4 / 6.0));
  seen.see(row);
  CHECK(seen.surface.friction_share() == Approx(3 / 6.0));
  seen.see(row);
  CHECK(seen.surface.friction_share() == Approx(4 / 6.0));
  // Whoever builds a surface without its motion has no friction.
  seen.surface.build(row, seen.region);
  CHECK(seen.surface.largest_friction(0.6f) == 0);
}

TEST_CASE("each thing has a friction that fades in for itself", "[seen_object][friction]") {
  SeenThings seen;
  std::vector<ObjectBall> balls = row_of_balls(Vector3f::Zero());
  for (int frame = 0; frame < 7; ++frame) seen.see(balls);
  const Vector3f beside(0, 0.1f, 0);
  for (const ObjectBall& ball : row_of_balls(beside)) balls.push_back(ball);
  seen.see(balls);
  CHECK(seen.share_at(Vector3f::Zero()) == 1);
  CHECK(seen.share_at(beside) == 0);
  seen.see(balls);
  CHECK(seen.share_at(Vector3f::Zero()) == 1);
  CHECK(seen.share_at(beside) == Approx(1 / 6.0));
}

TEST_CASE("a thing that rests carries nothing along for 20 s", "[seen_object][friction]") {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    SeenThings seen;
    CarriedPlace place;
    float farthest = 0;
    seen.see(row_of_balls(Vector3f::Zero(), &random));
    for (int frame = 0; frame < 600; ++frame) {
      seen.see(row_of_balls(Vector3f::Zero(), &random));
      place.follow(seen);
      farthest = std::max(farthest, place.way().norm());
    }
    CHECK(farthest < tolerance(3e-4f, "m: the bar"));
  }
}

TEST_CASE("a thing that moves carries along, there and back", "[seen_object][friction]") {
  auto random = test::random_case(1);
  SeenThings seen;
  CarriedPlace place;
  Vector3f middle = Vector3f::Zero();
  for (int frame = 0; frame < 10; ++frame) seen.see(row_of_balls(middle, &random));
  const auto go = [&](float step, int frames) {
    for (int frame = 0; frame < frames; ++frame) {
      middle.y() += step;
      seen.see(row_of_balls(middle, &random));
      place.follow(seen);
    }
  };
  go(kStep, 1);
  CHECK(place.way().norm() == 0);  // less than three sigma
  go(kStep, 19);
  CHECK(place.way().y() == Approx(middle.y()).margin(tolerance(1e-4, "m: what is forgotten")));
  // A turn in motion is followed at once.
  const float turned = place.way().y();
  go(-kStep, 1);
  CHECK(place.way().y() == Approx(turned - kStep).margin(tolerance(5e-5, "m")));
  go(-kStep, 19);
  CHECK(place.way().y() == Approx(0).margin(tolerance(1e-4, "m")));
}

TEST_CASE("from rest a thing moves by three standard deviations in each direction",
          "[seen_object][friction]") {
  for (const float side : {1.0f, -1.0f}) {
    SeenThings seen;
    CarriedPlace place;
    Vector3f middle = Vector3f::Zero();
    // To the right first, so that it comes to rest from there.
    for (int frame = 0; frame < 10; ++frame) {
      if (frame > 0) middle.y() += kStep;
      seen.see(row_of_balls(middle));
    }
    for (int frame = 0; frame < 20; ++frame) seen.see(row_of_balls(middle));
    place.place.place = middle + Vector3f(0, 0.008f, 0);
    const auto is_followed = [&] {
      middle.y() += side * kSigma / 2;
      seen.see(row_of_balls(middle));
      const Vector3f before = place.place.place;
      place.follow(seen);
      return place.place.place != before;
    };
    int frames = 1;
    while (!is_followed() && frames < 20) ++frames;
    CHECK((frames == 7 || frames == 8));  // 3.5 sigma: a little of it is forgotten on the way
  }
}

TEST_CASE("after a gap the way of a thing is that of its middle, which is said",
          "[seen_object][friction]") {
  SeenThings seen;
  CarriedPlace place;
  for (int frame = 0; frame < 8; ++frame) seen.see(row_of_balls(Vector3f::Zero()));
  for (const ObjectBall& ball : seen.surface.balls()) CHECK_FALSE(ball.way_is_mean);
  seen.time += 0.5;
  const Vector3f jump(0.002f, -0.015f, 0.001f);
  seen.see(row_of_balls(jump));
  REQUIRE(seen.surface.balls().size() == 9);
  for (const ObjectBall& ball : seen.surface.balls()) {
    CHECK(ball.way_is_mean);
    CHECK((ball.way - jump).norm() < tolerance(1e-6f, "m: rounding"));
    CHECK(ball.friction_share == Approx(5 / 6.0));
  }
  seen.see(row_of_balls(jump));
  for (const ObjectBall& ball : seen.surface.balls()) CHECK_FALSE(ball.way_is_mean);
  CHECK(seen.surface.friction_share() == Approx(1.0));
}

TEST_CASE("far from its ends a rod has the mean of its way along itself, which is said",
          "[seen_object][friction]") {
  SeenThings seen;
  std::vector<ObjectBall> balls;
  for (int frame = 0; frame < 8; ++frame) {
    balls.clear();
    // 0.36 m long
    for (int k = -90; k <= 90; ++k) {
      ObjectBall ball = row_of_balls({0, kStep * static_cast<float>(frame), 0}).front();
      ball.centre.x() = 0.002f * static_cast<float>(k);
      balls.push_back(ball);
    }
    seen.region = {Vector3d::Constant(-0.3), Vector3d::Constant(0.3)};
    seen.see(balls);
  }
  const std::size_t middle = balls.size() / 2;
  CHECK(seen.surface.balls()[middle].way_is_mean);
  CHECK_FALSE(seen.surface.balls().front().way_is_mean);  // its end determines it
  // Across itself it is known.
  CHECK(seen.surface.balls()[middle].way.y() == Approx(kStep).margin(tolerance(5e-5, "m")));
}

TEST_CASE("the motion of what is seen allocates nothing", "[seen_object][friction]") {
  SeenThings seen;
  std::vector<std::vector<ObjectBall>> frames;
  for (int k = 0; k < 10; ++k) {
    frames.push_back(row_of_balls({0, kStep * static_cast<float>(k), 0}));
  }
  frames[5].clear();
  seen.see(frames[0]);
  CHECK(test::allocations_during([&] {
          for (const auto& balls : frames) seen.see(balls);
        }) == 0);
}

}  // namespace
}  // namespace palpable
