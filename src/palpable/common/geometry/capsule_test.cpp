#include "palpable/common/geometry/capsule.h"

#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace palpable;
using palpable::test::random_case;
using palpable::test::tolerance;

namespace {

Eigen::Vector3d some_point(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  const double x = uniform(random);
  const double y = uniform(random);
  return {x, y, uniform(random)};
}

Capsule some_capsule(unsigned seed) {
  auto random = random_case(seed);
  std::uniform_real_distribution<double> radius(0.1, 0.6);
  Capsule c;
  c.a = some_point(random, 1.0);
  c.b = c.a + 0.8 * some_point(random, 1.0).normalized();
  c.ra = radius(random);
  c.rb = radius(random);
  return c;
}

/// The distance by the definition, sampled: the hull of two spheres is the union of the spheres
/// between them, whose radius changes linearly.
double sampled_distance(const Capsule& c, const Eigen::Vector3d& x) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 20000; ++i) {
    const double t = i / 20000.0;
    nearest = std::min(nearest, (x - (c.a + t * (c.b - c.a))).norm() - (c.ra + t * (c.rb - c.ra)));
  }
  return nearest;
}

}  // namespace

TEST_CASE("the distance to a capsule is the distance to the nearest sphere it sweeps",
          "[geometry]") {
  for (unsigned seed = 0; seed < 30; ++seed) {
    INFO("seed " << seed);
    const Capsule c = some_capsule(seed);
    auto random = random_case(seed + 1000);
    for (int i = 0; i < 5; ++i) {
      const Eigen::Vector3d x = c.a + some_point(random, 1.5);
      const double exact = signed_distance(c, x);
      const double sampled = sampled_distance(c, x);
      // Inside, the sampled depth is only that within one sphere of the union; the depth within the
      // hull may be larger.
      if (sampled > 0.0)
        CHECK(std::abs(exact - sampled) <= tolerance(1e-7, "the parabola's bottom, step 5e-5"));
      else
        CHECK(exact <= sampled + 1e-12);
    }
  }
}

TEST_CASE("a straight capsule has the closed form of segment and radius", "[geometry]") {
  const Capsule c{{0, 0, 0}, {2, 0, 0}, 0.5, 0.5};
  CHECK(signed_distance(c, {1, 0, 3}) == 2.5);
  CHECK(signed_distance(c, {-4, 0, 0}) == 3.5);
  CHECK(signed_distance(c, {2, 0, 0}) == -0.5);
  CHECK(signed_distance(c, {5, 4, 0}) == 4.5);
}

TEST_CASE("a sphere within a sphere is the larger sphere", "[geometry]") {
  const Capsule c{{0, 0, 0}, {0.1, 0, 0}, 1.0, 0.2};
  CHECK(signed_distance(c, {3, 0, 0}) == 2.0);
  CHECK(CapsuleField(c).normal({3, 0, 0}) == Eigen::Vector3d::UnitX());
}

TEST_CASE("the distance to no capsules is infinite, that to a union is that to its nearest part",
          "[geometry]") {
  CHECK(signed_distance(std::vector<Capsule>{}, {0, 0, 0}) ==
        std::numeric_limits<double>::infinity());
  const std::vector<Capsule> two = {some_capsule(1), some_capsule(2)};
  const Eigen::Vector3d x(2, 1, -3);
  CHECK(signed_distance(two, x) ==
        std::min(signed_distance(two[0], x), signed_distance(two[1], x)));
}

TEST_CASE("the normal is the gradient of the distance", "[geometry]") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    const Capsule c = some_capsule(seed);
    auto random = random_case(seed + 500);
    const Eigen::Vector3d x = c.b + some_point(random, 1.2);
    constexpr double kStep = 1e-6;
    Eigen::Vector3d gradient;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d h = kStep * Eigen::Vector3d::Unit(i);
      gradient[i] = (signed_distance(c, x + h) - signed_distance(c, x - h)) / (2 * kStep);
    }
    CHECK((gradient - CapsuleField(c).normal(x)).norm() <=
          tolerance(1e-7, "second differences of a radius 0.1 over 1e-6"));
  }
}

TEST_CASE("a ray meets a capsule where its surface is, and misses what is beside it",
          "[geometry]") {
  const std::vector<Capsule> hand = {{{0, 0, 5}, {2, 0, 5}, 0.5, 0.5}};
  CHECK(std::abs(ray_distance(hand, {1, 0, 0}, {0, 0, 1}, 100) - 4.5) <=
        tolerance(1e-6, "where sphere tracing stops"));
  CHECK(std::isinf(ray_distance(hand, {1, 2, 0}, {0, 0, 1}, 100)));
  CHECK(std::isinf(ray_distance(hand, {1, 0, 0}, {0, 0, 1}, 4.0)));
}

TEST_CASE("normal and curvature of a capsule's distance are its derivatives", "[geometry]") {
  for (unsigned seed = 0; seed < 30; ++seed) {
    INFO("seed " << seed);
    const Capsule c = some_capsule(seed);
    const CapsuleField field(c);
    auto random = random_case(seed + 2000);
    for (int i = 0; i < 5; ++i) {
      const Eigen::Vector3d x = c.a + some_point(random, 1.5);
      const Eigen::Matrix3d curvature = field.curvature(x);
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d step = 1e-6 * Eigen::Vector3d::Unit(axis);
        const Eigen::Vector3d slope = (field.normal(x + step) - field.normal(x - step)) / 2e-6;
        const double change = (field.distance(x + step) - field.distance(x - step)) / 2e-6;
        CHECK(std::abs(change - field.normal(x)[axis]) <=
              tolerance(1e-7, "central differences of 1e-6"));
        CHECK((slope - curvature.col(axis)).norm() <=
              tolerance(1e-5, "central differences of 1e-6, points near the axis"));
      }
    }
  }
}

TEST_CASE("a capsule on its way keeps its length and turns on the shortest way", "[geometry]") {
  for (unsigned seed = 0; seed < 10; ++seed) {
    INFO("seed " << seed);
    const Capsule from = some_capsule(seed);
    Capsule to = some_capsule(seed + 100);
    to.b = to.a + (to.b - to.a).normalized() * (from.b - from.a).norm();
    const Eigen::Vector3d axis = (from.b - from.a).normalized(),
                          turned = (to.b - to.a).normalized();
    const double angle = std::acos(std::clamp(axis.dot(turned), -1.0, 1.0));
    for (const double t : {0.0, 0.3, 1.0}) {
      const Capsule now = interpolated(from, to, t);
      CHECK((now.a - ((1 - t) * from.a + t * to.a)).norm() < tolerance(1e-12, "m: rounding"));
      CHECK((now.b - now.a).norm() == Approx((from.b - from.a).norm()));
      const Eigen::Vector3d here = (now.b - now.a).normalized();
      CHECK(std::acos(std::clamp(here.dot(axis), -1.0, 1.0)) ==
            Approx(t * angle).margin(tolerance(1e-6, "the arc cosine near 1")));
      CHECK(std::abs(here.dot(axis.cross(turned))) < tolerance(1e-12, "rounding"));
      CHECK(now.ra == Approx((1 - t) * from.ra + t * to.ra));
    }
  }
  const Capsule ball{{0, 0, 0}, {0, 0, 0}, 1, 1}, moved{{2, 0, 0}, {2, 0, 0}, 3, 3};
  const Capsule now = interpolated(ball, moved, 0.5);
  CHECK(now.a == Eigen::Vector3d(1, 0, 0));
  CHECK(now.b == now.a);
  CHECK(now.ra == 2);
}
