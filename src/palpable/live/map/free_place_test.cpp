#include "palpable/live/map/free_place.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <cmath>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;

const PinholeCamera kCamera{320, 180, 170, 175, 165.2, 88.1};
const DepthNoise kNoise{0, 0, 0.004};
const Footprint kBody{0.06, 0.12};

struct Ball {
  Vector3d middle;
  double radius;
};

// Z at which a ray meets a ball; infinite if it does not.
double depth_of(const Ball& ball, const Vector3d& ray) {
  const double a = ray.squaredNorm(), b = ray.dot(ball.middle);
  const double c = ball.middle.squaredNorm() - ball.radius * ball.radius;
  const double root = b * b - a * c;
  return root < 0 ? INFINITY : (b - std::sqrt(root)) / a;
}

// A desk with balls that lie on it.
DepthImage desk(const Plane& plane, const std::vector<Ball>& balls, unsigned seed) {
  auto random = test::random_case(seed);
  std::normal_distribution<double> scatter;
  DepthImage depth(kCamera.width, kCamera.height, std::nanf(""));
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const Vector3d ray = kCamera.unproject(x, y, 1.0);
      const double along = plane.normal.dot(ray);
      double Z = along < 0 ? plane.offset / along : INFINITY;
      for (const Ball& ball : balls) Z = std::min(Z, depth_of(ball, ray));
      if (Z > 1.2 || (x + 7 * y) % 10 == 0) continue;
      depth(x, y) = static_cast<float>(Z + kNoise.sigma(Z) * scatter(random));
    }
  }
  return depth;
}

Plane desk_plane(const Vector3d& towards) {
  Plane plane;
  plane.normal = towards.normalized();
  plane.offset = -0.5;
  const Vector3d ray = kCamera.unproject(160, 90, 1.0);
  plane.middle = ray * (plane.offset / plane.normal.dot(ray));
  return plane;
}

Ball on(const Plane& plane, const Vector3d& off, double radius) {
  const Rigid3 pose = camera_from_body_on(plane);
  return {pose * (off + Vector3d(0, 0, radius)), radius};
}

TEST_CASE("a body stands in the middle of an empty desk, and beside what stands there",
          "[map][free_place]") {
  for (const Vector3d& normal : {Vector3d(0.05, -0.7, -0.7), Vector3d(0.02, 0.01, -1)}) {
    const Plane plane = desk_plane(normal);
    INFO("normal " << plane.normal.transpose());
    const auto empty = free_place_on(plane, desk(plane, {}, 1), kCamera, kNoise, kBody);
    REQUIRE(empty);
    CHECK(*empty == plane.middle);
    for (unsigned seed = 0; seed < 6; ++seed) {
      INFO("seed " << seed);
      const std::vector<Ball> balls{on(plane, {0.02, 0.0, 0}, 0.05),
                                    on(plane, {0.04 * seed - 0.1, -0.15, 0}, 0.04)};
      const auto place = free_place_on(plane, desk(plane, balls, seed), kCamera, kNoise, kBody);
      REQUIRE(place);
      CHECK(std::abs(plane.normal.dot(*place) - plane.offset) <= 1e-9);
      for (const Ball& ball : balls) {
        const Vector3d foot = ball.middle - ball.radius * plane.normal;
        CHECK((foot - *place).norm() >=
              kBody.radius + ball.radius -
                  test::tolerance(0.01, "m, a cell; its back is not seen"));
      }
      CHECK((*place - plane.middle).norm() < 0.3);  // and not farther away than necessary
    }
  }
}

TEST_CASE("what is too high for the body, lies below the desk or is out of sight is no place",
          "[map][free_place]") {
  const Plane plane = desk_plane({0.05, -0.7, -0.7});
  // A lamp that hangs above the body's height does not block the middle.
  const Ball lamp{plane.middle + 0.25 * plane.normal, 0.02};
  const auto below = free_place_on(plane, desk(plane, {lamp}, 1), kCamera, kNoise, kBody);
  REQUIRE(below);
  CHECK((*below - plane.middle).norm() < 0.1);
  // There is no position on a desk that is full of things, or on one that is not visible.
  std::vector<Ball> many;
  for (int j = -12; j <= 12; ++j) {
    for (int i = -12; i <= 12; ++i) many.push_back(on(plane, {0.1 * i, 0.1 * j, 0}, 0.03));
  }
  CHECK_FALSE(free_place_on(plane, desk(plane, many, 1), kCamera, kNoise, kBody));
  const DepthImage nothing(kCamera.width, kCamera.height, std::nanf(""));
  CHECK_FALSE(free_place_on(plane, nothing, kCamera, kNoise, kBody));
  CHECK_THROWS_AS(free_place_on(plane, nothing, kCamera, kNoise, {5, 0.1}), ContractViolation);
  CHECK_THROWS_AS(free_place_on(plane, DepthImage(10, 10), kCamera, kNoise, kBody),
                  ContractViolation);
}

}  // namespace
}  // namespace palpable
