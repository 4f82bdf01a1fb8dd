#include "palpable/desk/score/penetration.h"

#include "palpable/desk/score/deepest_sample.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

TEST_CASE("the distance to a capsule of constant radius is that to its axis minus the radius",
          "[score]") {
  const Capsule capsule{{0, 0, 0}, {0, 0, 0.1}, 0.01, 0.01};
  CHECK(distance_to(capsule, {0.03, 0, 0.05}) == Approx(0.02));
  CHECK(distance_to(capsule, {0.004, 0, 0.05}) == Approx(-0.006));
  CHECK(distance_to(capsule, {0, 0, -0.03}) == Approx(0.02));
  CHECK(distance_to(capsule, {0, 0.03, 0.14}) == Approx(0.04));
}

TEST_CASE("the distance to a tapered capsule is the least over all its balls", "[score][law]") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<double> place(-0.05, 0.05), radius(0.005, 0.03);
    const auto point = [&] { return Vector3d(place(random), place(random), place(random)); };
    const Capsule capsule{point(), point(), radius(random), radius(random)};
    for (int i = 0; i < 50; ++i) {
      const Vector3d x = 1.5 * point();
      double least = std::numeric_limits<double>::infinity();
      for (int j = 0; j <= 2000; ++j) {
        const double t = j / 2000.0;
        least = std::min(least, (x - capsule.a - t * (capsule.b - capsule.a)).norm() -
                                    (capsule.ra + t * (capsule.rb - capsule.ra)));
      }
      CHECK(std::abs(distance_to(capsule, x) - least) <
            tolerance(2e-7, "balls every 0.1 mm: (5e-5)^2 / 2 over the distance of at least 6 mm"));
    }
  }
}

TEST_CASE("an end ball inside the other one changes nothing", "[score]") {
  const Capsule capsule{{0, 0, 0}, {0, 0, 0.005}, 0.02, 0.01};
  CHECK(distance_to(capsule, {0, 0, 0.03}) == Approx(0.01));
  CHECK(distance_to({capsule.b, capsule.a, 0.01, 0.02}, {0, 0, 0.03}) == Approx(0.01));
  CHECK(distance_to({{1, 2, 3}, {1, 2, 3}, 0.5, 0.5}, {1, 2, 4}) == Approx(0.5));
}

// A mesh of degenerate triangles, one at each of the given points.
SurfaceMesh points(const std::vector<Vector3d>& at) {
  SurfaceMesh surface;
  surface.vertices.resize(3, static_cast<Eigen::Index>(at.size()));
  surface.triangles.resize(3, surface.vertices.cols());
  for (Eigen::Index i = 0; i < surface.vertices.cols(); ++i) {
    surface.vertices.col(i) = at[i];
    surface.triangles.col(i).setConstant(static_cast<int>(i));
  }
  return surface;
}

TEST_CASE("the penetration is that of the deepest vertex in any capsule", "[score]") {
  const Vector3d outside(0.5, 0, 0);
  const Vector3d in_first(0.007, 0, 0.05);    // 3 mm inside
  const Vector3d in_second(0.2, 0.001, 0);    // 19 mm inside
  const Vector3d also_second(0.2, 0.010, 0);  // 10 mm inside
  const std::vector<Capsule> capsules{{{0, 0, 0}, {0, 0, 0.1}, 0.01, 0.01},
                                      {{0.2, 0, 0}, {0.2, 0, 0}, 0.02, 0.02}};
  CHECK(deepest_penetration(points({outside, in_first, in_second, also_second}), capsules) ==
        Approx(0.019));
  CHECK(deepest_penetration(points({outside, in_first}), capsules) == Approx(0.003));
  CHECK(deepest_penetration(points({outside}), capsules) == 0);
  CHECK(deepest_penetration(points({outside, in_first}), {}) == 0);
}

// A right triangle with legs of 40 mm in the plane Z = 0.
SurfaceMesh large_triangle() {
  SurfaceMesh surface;
  surface.vertices.resize(3, 3);
  surface.vertices.col(0) = Vector3d(0, 0, 0);
  surface.vertices.col(1) = Vector3d(0.04, 0, 0);
  surface.vertices.col(2) = Vector3d(0, 0.04, 0);
  surface.triangles.resize(3, 1);
  surface.triangles.col(0) = Eigen::Vector3i(0, 1, 2);
  return surface;
}

TEST_CASE("a pencil that comes through between the vertices is found", "[score]") {
  // A tip of 1.2 mm radius that reaches 5 mm through the plane: the plane is 1.2 mm deep on its
  // axis.
  const std::vector<Capsule> pencil{
      {{0.0117, 0.0093, -0.005}, {0.0117, 0.0093, 0.1}, 0.0012, 0.0012}};
  const double depth = deepest_penetration(large_triangle(), pencil);
  // With samples 1.25 mm apart (40 mm / 32), one is nearer to the axis than 0.9 mm.
  CHECK(depth <= 0.0012);
  CHECK(depth >= 0.0012 - 0.0009);
}

TEST_CASE("skipping parts does not change the result: all samples give the same depth",
          "[score][law]") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<double> place(-0.03, 0.06), radius(0.001, 0.02);
    const auto point = [&] { return Vector3d(place(random), place(random), 0.5 * place(random)); };
    std::vector<Capsule> hand;
    for (int i = 0; i < 3; ++i) hand.push_back({point(), point(), radius(random), radius(random)});
    // The longest edge, 40 sqrt(2) mm, is halved five times to be at most 2 mm: 32 parts.
    double deepest = 0;
    for (int i = 0; i <= 32; ++i) {
      for (int j = 0; i + j <= 32; ++j) {
        const Vector3d x(0.04 * i / 32, 0.04 * j / 32, 0);
        for (const Capsule& c : hand) deepest = std::max(deepest, -distance_to(c, x));
      }
    }
    CHECK(std::abs(deepest_penetration(large_triangle(), hand) - deepest) <=
          tolerance(1e-15, "rounding of sums in another order"));
  }
}

TEST_CASE("a triangle of 1000 km is searched quickly", "[score]") {
  SurfaceMesh huge = large_triangle();
  huge.vertices *= 25e3;
  const std::vector<Capsule> ball{{{10, 10, 0}, {10, 10, 0}, 3, 3}};
  CHECK(deepest_penetration(huge, ball) == Approx(3).margin(0.2));
}

}  // namespace
}  // namespace palpable
