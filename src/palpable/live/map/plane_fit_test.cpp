#include "palpable/live/map/plane_fit.h"

#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace palpable {
namespace {

const PinholeCamera kCamera{320, 180, 170, 175, 165.2, 88.1};
const DepthNoise kNoise{0, 0, 0.012};

// A desk with a box on it and a wall behind, a tenth of the pixels unknown.
DepthImage desk(const Eigen::Vector3d& normal, double offset, unsigned seed) {
  auto random = test::random_case(seed);
  std::normal_distribution<double> scatter;
  DepthImage depth(kCamera.width, kCamera.height);
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const double along = normal.dot(kCamera.unproject(x, y, 1.0));
      double Z = along < 0 ? std::min(offset / along, 1.3) : 1.3;
      if (x > 60 && x < 130 && y > 70 && y < 140) Z = std::min(Z, 0.45);
      Z += kNoise.sigma(Z) * scatter(random);
      depth(x, y) = (x + 7 * y) % 10 == 0 ? std::nanf("") : static_cast<float>(Z);
    }
  }
  return depth;
}

TEST_CASE("a desk is found beside a box and before a wall", "[map][plane_fit]") {
  for (unsigned seed = 0; seed < 10; ++seed) {
    INFO("seed " << seed);
    const Eigen::Vector3d normal = Eigen::Vector3d(0.05 * seed - 0.2, -0.85, -0.5).normalized();
    const double offset = -0.35;
    const auto plane = fit_standing_plane(desk(normal, offset, seed), kCamera, kNoise);
    REQUIRE(plane);
    const double angle = std::acos(std::min(1.0, plane->normal.dot(normal)));
    CHECK(angle * 180 / std::numbers::pi <=
          test::tolerance(0.15,
                          "2500 points of 3-7 mm over 0.5 m give 0.03 degrees; the rims of box "
                          "and wall pull"));
    CHECK(std::abs(plane->offset - offset) <= test::tolerance(1e-3, "the same in mm"));
    CHECK(std::abs(plane->normal.dot(plane->middle) - plane->offset) <= 1e-9);
    const Rigid3 pose = camera_from_body_on(*plane);
    CHECK((pose.linear() * Eigen::Vector3d::UnitZ() - plane->normal).norm() <= 1e-12);
    CHECK(std::abs(pose.linear().determinant() - 1) <= 1e-12);
    CHECK(pose.linear()(0, 0) > 0.9);
  }
}

TEST_CASE("the surface at a pixel is found, whatever way it faces, and none where it is not known",
          "[map][plane_fit]") {
  for (unsigned seed = 0; seed < 10; ++seed) {
    INFO("seed " << seed);
    const Eigen::Vector3d normal = Eigen::Vector3d(0.05 * seed - 0.2, -0.85, -0.5).normalized();
    const DepthImage depth = desk(normal, -0.35, seed);
    const struct {
      double x, y;
      Eigen::Vector3d normal;
      double offset;
    } places[] = {{200.3, 150.6, normal, -0.35},                // the desk
                  {95, 105, -Eigen::Vector3d::UnitZ(), -0.45},  // the box's front
                  {200, 12, -Eigen::Vector3d::UnitZ(), -1.3}};  // the wall
    for (const auto& place : places) {
      INFO("at " << place.x << ", " << place.y);
      const auto plane = fit_plane_at(depth, kCamera, kNoise, place.x, place.y);
      REQUIRE(plane);
      const Eigen::Vector3d ray = kCamera.unproject(place.x, place.y, 1.0);
      const Eigen::Vector3d there = ray * (place.offset / place.normal.dot(ray));
      const double sigma = kNoise.sigma(there.z());
      CHECK((plane->middle - there).norm() <=
            test::tolerance(sigma, "of a mean of some hundred points, under a slant"));
      CHECK(plane->normal.dot(place.normal) >=
            1 - test::tolerance(0.5 * std::pow(6 * sigma / 0.04 / 10, 2) + 1e-3,
                                "a hundred points of that noise over 4 cm"));
    }
    // At the box's rim the plane is its front or the desk behind, not a plane between them.
    if (const auto rim = fit_plane_at(depth, kCamera, kNoise, 130, 105)) {
      const bool front = rim->normal.dot(-Eigen::Vector3d::UnitZ()) > 0.95;
      CHECK((front || rim->normal.dot(normal) > 0.95));
    }
    for (const auto& [x, y] : {std::pair{-3.0, 40.0}, {400.0, 40.0}, {40.0, 1e9}}) {
      CHECK_FALSE(fit_plane_at(depth, kCamera, kNoise, x, y));
    }
  }
  DepthImage unknown(kCamera.width, kCamera.height, 0.5F);
  for (int y = 80; y < 100; ++y) std::fill(unknown.row(y), unknown.row(y) + 320, std::nanf(""));
  CHECK_FALSE(fit_plane_at(unknown, kCamera, kNoise, 160, 90));
  CHECK(fit_plane_at(unknown, kCamera, kNoise, 160, 120));
}

TEST_CASE("a plane that is seen from elsewhere is the same plane", "[map][plane_fit]") {
  const Rigid3 to_from = Eigen::Translation3d(0.3, -0.2, 0.5) *
                         Rigid3(Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, -2, 0.5).normalized()));
  const Eigen::Vector3d normal = Eigen::Vector3d(0.1, -0.8, -0.5).normalized();
  const Plane plane{normal, -0.35, 0.4, -0.35 * normal};
  const Plane moved = moved_by(to_from, plane);
  const Eigen::Vector3d on_plane = plane.middle + 0.2 * normal.unitOrthogonal();
  const double rounding = test::tolerance(1e-12, "rounding");
  CHECK(std::abs(moved.normal.dot(to_from * on_plane) - moved.offset) < rounding);
  CHECK(std::abs(moved.normal.dot(to_from * (on_plane + 0.1 * normal)) - moved.offset - 0.1) <
        rounding);
  CHECK((moved.middle - to_from * plane.middle).norm() < rounding);
  CHECK(moved.share == plane.share);
}

// A plane that fills the picture, without noise.
DepthImage alone(const Eigen::Vector3d& normal, double offset) {
  DepthImage depth(kCamera.width, kCamera.height);
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      depth(x, y) = static_cast<float>(offset / normal.dot(kCamera.unproject(x, y, 1.0)));
    }
  }
  return depth;
}

TEST_CASE("a camera that looks straight down sees the desk, whichever way it is turned",
          "[map][plane_fit]") {
  for (const double tilt : {-0.35, -0.1, 0.0, 0.1, 0.35}) {
    INFO("tilt " << tilt);
    const Eigen::Vector3d normal(0.05, std::sin(tilt), -std::cos(tilt));
    const auto plane = fit_standing_plane(alone(normal.normalized(), -0.6), kCamera, kNoise);
    REQUIRE(plane);
    CHECK((plane->normal - normal.normalized()).norm() <= test::tolerance(1e-4, "floats"));
    const Rigid3 pose = camera_from_body_on(*plane);
    CHECK((pose.linear().col(2) - plane->normal).norm() <= 1e-12);
    CHECK(pose.linear()(0, 0) > 0.9);
  }
}

TEST_CASE("a wall beside the camera is nothing to stand on, and neither is nothing",
          "[map][plane_fit]") {
  const Eigen::Vector3d turned(std::sin(0.6), 0, -std::cos(0.6));
  CHECK_FALSE(fit_standing_plane(alone(turned, -0.7), kCamera, kNoise));
  const Eigen::Vector3d ceiling = Eigen::Vector3d(0, 0.8, -0.6);
  CHECK_FALSE(fit_standing_plane(alone(ceiling, -0.5), kCamera, kNoise));
  // A wall that fills less than half of the near pixels is behind other things.
  DepthImage behind(kCamera.width, kCamera.height, 0.8F);
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < 200; ++x)
      behind(x, y) = 0.4F + 0.3F * static_cast<float>((7 * x + 3 * y) % 11) / 11;
  }
  CHECK_FALSE(fit_standing_plane(behind, kCamera, kNoise));
  const DepthImage unknown(kCamera.width, kCamera.height, std::nanf(""));
  CHECK_FALSE(fit_standing_plane(unknown, kCamera, kNoise));
}

TEST_CASE("whatever the depth, a plane is finite or there is none", "[map][plane_fit]") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    auto random = test::random_case(seed);
    std::uniform_real_distribution<float> any(-1, 2);
    DepthImage depth(kCamera.width, kCamera.height);
    for (float& Z : depth) Z = any(random);
    const auto plane = fit_standing_plane(depth, kCamera, kNoise);
    if (plane) CHECK(camera_from_body_on(*plane).matrix().allFinite());
  }
}

}  // namespace
}  // namespace palpable
