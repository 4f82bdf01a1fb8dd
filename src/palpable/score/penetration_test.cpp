#include "palpable/score/penetration.h"

#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

TEST_CASE("beside an even capsule the distance is that to its axis less the radius", "[score]") {
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

TEST_CASE("a ball within the other end's ball adds nothing", "[score]") {
  const Capsule capsule{{0, 0, 0}, {0, 0, 0.005}, 0.02, 0.01};
  CHECK(distance_to(capsule, {0, 0, 0.03}) == Approx(0.01));
  CHECK(distance_to({capsule.b, capsule.a, 0.01, 0.02}, {0, 0, 0.03}) == Approx(0.01));
  CHECK(distance_to({{1, 2, 3}, {1, 2, 3}, 0.5, 0.5}, {1, 2, 4}) == Approx(0.5));
}

TEST_CASE("the penetration is that of the deepest vertex in any capsule", "[score]") {
  Eigen::Matrix3Xd vertices(3, 4);
  vertices.col(0) = Vector3d(0.5, 0, 0);       // far outside
  vertices.col(1) = Vector3d(0.007, 0, 0.05);  // 3 mm inside the first
  vertices.col(2) = Vector3d(0.2, 0.001, 0);   // 19 mm inside the second
  vertices.col(3) = Vector3d(0.2, 0.010, 0);   // 10 mm inside the second
  const std::vector<Capsule> capsules{{{0, 0, 0}, {0, 0, 0.1}, 0.01, 0.01},
                                      {{0.2, 0, 0}, {0.2, 0, 0}, 0.02, 0.02}};
  CHECK(deepest_penetration(vertices, capsules) == Approx(0.019));
  CHECK(deepest_penetration(vertices.leftCols(2), capsules) == Approx(0.003));
  CHECK(deepest_penetration(vertices.leftCols(1), capsules) == 0);
  CHECK(deepest_penetration(vertices, {}) == 0);
}

}  // namespace
}  // namespace palpable
