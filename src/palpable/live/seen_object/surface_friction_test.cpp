#include "palpable/live/seen_object/surface_friction.h"

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

// A row of balls along x as a camera above sees them, moved by `way`.
std::vector<ObjectBall> row_of_balls(const Vector3f& way, std::mt19937_64* noise = nullptr) {
  std::normal_distribution<float> tremble(0, kSigma / 4);
  std::vector<ObjectBall> balls;
  for (int k = 0; k < 9; ++k) {
    ObjectBall ball;
    ball.centre = Vector3f(0.004f * static_cast<float>(k - 4), 0, 0) + way;
    if (noise != nullptr) ball.centre.z() += tremble(*noise);
    ball.radius = 0.008f;
    ball.normal = Vector3f::UnitZ();
    ball.point = ball.centre + ball.radius * ball.normal;
    ball.sigma = kSigma;
    balls.push_back(ball);
  }
  return balls;
}

struct Seen {
  ObjectSurface surface;
  SurfaceFriction friction;
  Eigen::AlignedBox3d region{Vector3d::Constant(-0.1), Vector3d::Constant(0.1)};
  int frame = 0;

  void see(const std::vector<ObjectBall>& balls) {
    const Vector3f camera(0, 0, 0.5f);
    surface.build(balls, region, camera);
    friction.add(surface, camera, frame++ / kRate);
  }
};

TEST_CASE("friction fades in over six frames, and without a thing there is none",
          "[seen_object][friction]") {
  Seen seen;
  seen.see(row_of_balls(Vector3f::Zero()));
  CHECK(seen.surface.friction_share() == 0);  // it is not known yet how it moves
  float last = 0;
  for (int frame = 0; frame < 6; ++frame) {
    seen.see(row_of_balls(Vector3f::Zero()));
    CHECK(seen.surface.friction_share() > last);
    last = seen.surface.friction_share();
  }
  CHECK(last == 1);
  CHECK(seen.surface.largest_friction(0.6f) == 0.6f);
  seen.see({});
  CHECK(seen.surface.friction_share() == 0);
  // Whoever builds a surface without its motion has no friction.
  seen.see(row_of_balls(Vector3f::Zero()));
  seen.surface.build(row_of_balls(Vector3f::Zero()), seen.region);
  CHECK(seen.surface.largest_friction(0.6f) == 0);
}

TEST_CASE("a thing that rests carries nothing along, one that moves does",
          "[seen_object][friction]") {
  auto random = test::random_case(1);
  Seen seen;
  const Vector3f start(0, 0.008f, 0);  // a place on the side of the middle ball
  MaterialPoint place{-1, start};
  for (int frame = 0; frame < 300; ++frame) {
    seen.see(row_of_balls(Vector3f::Zero(), &random));
    const auto carried = seen.surface.carried(place);
    REQUIRE(carried);
    place = *carried;
  }
  CHECK(static_cast<double>((place.place - start).norm()) <
        tolerance(5e-4, "m: the surface trembles by 0.05 mm"));

  // Across its axis the outline shows the way.
  const Vector3f began = place.place;
  Vector3f way = Vector3f::Zero();
  for (int frame = 0; frame < 20; ++frame) {
    way.y() += 0.0005f;
    seen.see(row_of_balls(way, &random));
    place = *seen.surface.carried(place);
  }
  // Late by three sigma at most, and by what the velocity is late.
  CHECK((place.place - began).y() > way.y() - static_cast<float>(tolerance(0.002, "m")));
  CHECK((place.place - began).y() < way.y() + static_cast<float>(tolerance(0.0015, "m")));
}

}  // namespace
}  // namespace palpable
