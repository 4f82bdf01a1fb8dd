#include "palpable/common/contact/sharp_part.h"

#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/geometry/surface_distance.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::tolerance;

// A cube with corners at (0, 0, 0) and (0.1, 0.1, 0.1).
MovingSurface cube() {
  return MovingSurface(box_surface(Vector3d::Zero(), Vector3d::Constant(0.1)));
}

SharpPart needle(const Vector3f& a, const Vector3f& b, float radius = 1e-4f) {
  return {a, b, radius, radius};
}

// The same by many samples of the axis.
double by_samples(const SharpPart& part, const SurfaceDistance& skin) {
  double deepest = 0;
  for (int i = 0; i <= 4000; ++i) {
    const float t = static_cast<float>(i) / 4000;
    const Vector3f x = part.a + t * (part.b - part.a);
    const double r = static_cast<double>(part.radius_a + t * (part.radius_b - part.radius_a));
    deepest = std::max(deepest, r - skin.nearest(x.cast<double>()).distance);
  }
  return deepest;
}

TEST_CASE("a needle is as deep in a cube as its tip is below the face", "[contact][sharp]") {
  const MovingSurface skin = cube();
  const auto margin = tolerance(1e-6, "m: single precision");
  // In the middle of a triangle, 2.5 mm deep; the rest of the needle is outside.
  CHECK(depth_of(needle({0.06f, 0.03f, 0.0976f}, {0.06f, 0.03f, 0.3f}), skin) ==
        Approx(0.0025).margin(margin));
  CHECK(depth_of(needle({0.06f, 0.03f, 0.3f}, {0.06f, 0.03f, 0.0976f}), skin) ==
        Approx(0.0025).margin(margin));
  // Outside, and outside by less than its radius.
  CHECK(depth_of(needle({0.06f, 0.03f, 0.101f}, {0.06f, 0.03f, 0.3f}), skin) == 0);
  CHECK(depth_of(needle({0.06f, 0.03f, 0.101f}, {0.06f, 0.03f, 0.3f}, 0.003f), skin) ==
        Approx(0.002).margin(margin));
  // Right through the middle: nowhere is it deeper than half the cube.
  CHECK(depth_of(needle({0.05f, 0.05f, -1}, {0.05f, 0.05f, 1}), skin) ==
        Approx(0.0501).epsilon(0.1));
  // Beside the cube, and a ball around all of it.
  CHECK(depth_of(needle({0.2f, 0.05f, -1}, {0.2f, 0.05f, 1}), skin) == 0);
  const Vector3f middle = Vector3f::Constant(0.05f);
  CHECK(depth_of(needle(middle, middle, 1), skin) == Approx(1.05).epsilon(1e-5));
}

TEST_CASE("the depth of any part is that of many samples of its axis", "[contact][sharp]") {
  const SurfaceMesh mesh = sphere_surface({0, 0, 0.05}, 0.05, 2);
  const MovingSurface skin(mesh);
  const SurfaceDistance exact(mesh);
  int inside = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<float> place(-0.12f, 0.12f), radius(1e-4f, 0.004f);
    const auto some = [&] {
      const float x = place(random), y = place(random);
      return Vector3f(x, y, 0.05f + place(random));
    };
    const Vector3f a = some(), b = some();
    const float ra = radius(random), rb = radius(random);
    const SharpPart part{a, b, ra, rb};
    const double wanted = by_samples(part, exact), found = depth_of(part, skin);
    inside += wanted > kReached;
    CHECK(found <= wanted + tolerance(1e-4, "m: the samples lie 0.06 mm apart"));
    CHECK(found >= wanted - std::max(1.5e-4, 0.1 * wanted) - tolerance(1e-5, "m: float"));
  }
  CHECK(inside > 5);
  CHECK(inside < 55);
}

TEST_CASE("a part that lies along the skin is outside, or inside by its thicker end",
          "[contact][sharp]") {
  const MovingSurface skin = cube();
  const Vector3f a(0.0f, 0.05f, 0.10011f), b(0.1f, 0.05f, 0.10011f);
  CHECK(depth_of(needle(a, b), skin) == 0);
  CHECK(depth_of({a, b, 1e-4f, 0.002f}, skin) ==
        Approx(0.00189).margin(tolerance(1e-6, "m: single precision")));
}

TEST_CASE("a part of any radius that the skin encloses is as deep as its axis",
          "[contact][sharp]") {
  const SurfaceMesh ball = sphere_surface({0, 0, 0}, 0.05, 4);
  const MovingSurface skin(ball);
  const auto depth = [&](const Vector3f& a, const Vector3f& b, float radius) {
    return depth_of_enclosed({a, b, radius, radius}, skin);
  };
  const double facets = tolerance(3e-4, "m: the faces lie within the ball");
  for (const float radius : {0.001f, 0.0025f, 0.008f, 0.015f}) {
    CHECK(depth({0, 0, 0}, {0, 0, 0}, radius) ==
          Approx(0.05 + static_cast<double>(radius)).margin(facets));
    // One end, or the middle alone, is inside.
    CHECK(depth({0, 0, 0.03f}, {0, 0, 0.2f}, radius) ==
          Approx(0.02 + static_cast<double>(radius)).margin(facets));
    CHECK(depth({-0.1f, 0, 0}, {0.1f, 0, 0}, radius) ==
          Approx(0.05 + static_cast<double>(radius)).margin(facets));
    // It presses from outside: contact points judge that.
    CHECK(depth({0, 0, 0.051f}, {0, 0, 0.2f}, radius) == 0);
  }
}

TEST_CASE("judging a part allocates nothing", "[contact][sharp][allocation]") {
  const MovingSurface skin = cube();
  const SharpPart part = needle({0.05f, 0.04f, -1}, {0.05f, 0.04f, 1});
  double depth = 0;
  CHECK(test::allocations_during([&] { depth = depth_of(part, skin); }) == 0);
  CHECK(depth > 0);
}

TEST_CASE("only capsules that are sharp and near are given, as far as there is room",
          "[contact][sharp]") {
  CapsuleObstacles obstacles;
  const Capsule blunt{{0, 0, 0}, {0, 0, 0.1}, 0.008, 0.008},
      sharp{{0, 0, 0}, {0, 0, 0.1}, 0.001, 0.01}, far{{1, 0, 0}, {1, 0, 0.1}, 0.001, 0.001};
  obstacles.set(std::vector{blunt, sharp, far, sharp});
  const Eigen::AlignedBox3f box(Vector3f::Constant(-0.05f), Vector3f::Constant(0.05f));
  std::vector<SharpPart> parts;
  parts.reserve(3);
  obstacles.add_sharp_parts(box, 0.002f, parts);
  REQUIRE(parts.size() == 2);
  CHECK(parts[0].radius_a == 0.001f);
  CHECK(parts[0].radius_b == 0.01f);
  obstacles.add_sharp_parts(box, 0.002f, parts);
  CHECK(parts.size() == parts.capacity());
  parts.clear();
  obstacles.add_sharp_parts(box, 5e-4f, parts);
  CHECK(parts.empty());
}

TEST_CASE("the depth at a position is that of the deepest capsule", "[contact][sharp]") {
  CapsuleObstacles obstacles;
  const Vector3f x(0.001f, 0.002f, 0.003f);
  CHECK(obstacles.depth_at(x) == 0);
  obstacles.set(std::vector<Capsule>{{{0, 0, 0}, {0, 0, 0}, 0.01, 0.01},
                                     {{0, 0, 0}, {0, 0, 0.5}, 0.02, 0.02},
                                     {{1, 0, 0}, {1, 0, 0}, 0.9, 0.9}});
  CHECK(obstacles.depth_at(x) == Approx(0.02 - std::hypot(0.001, 0.002)).margin(1e-7));
  CHECK(obstacles.depth_at({0, 0, -0.03f}) == 0);
  // A ball of 1 m: the gap search reports it as well, the depth is the same.
  obstacles.set(std::vector<Capsule>{{{0.3, 0, 0}, {0.3, 0, 0}, 1, 1}});
  CHECK(obstacles.depth_at(x) == Approx(-gap_at(obstacles, x).distance));
}

TEST_CASE("contact points 2 mm apart let nothing blunter than a pencil enter", "[contact][sharp]") {
  const double radius = sharpest_radius(0.002);
  CHECK(radius < 0.0035);  // a pencil's tip is not judged as sharp,
  CHECK(radius > 0.002);   // and a knitting needle is
  // In the middle of an equilateral triangle of points, 2 mm / sqrt(3) from each.
  const double away = 0.002 / std::sqrt(3.0);
  CHECK(radius - std::sqrt(radius * radius - away * away) >= 0.95 * kReached);
}

}  // namespace
}  // namespace palpable
