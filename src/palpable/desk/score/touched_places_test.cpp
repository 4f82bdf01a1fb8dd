#include "palpable/desk/score/touched_places.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <algorithm>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

Capsule ball(const Vector3d& middle, double radius) { return {middle, middle, radius, radius}; }

// A block of 60 x 60 x 60 mm with 12 triangles: touches lie far from its vertices.
const SurfaceMesh kBlock = box_surface({-0.03, -0.03, 0}, {0.03, 0.03, 0.06});

TEST_CASE("finger and thumb touch two places, a hand in the air none", "[score]") {
  // One ball on the top, one on the right side, and one 1 mm away from the left side.
  const std::vector<Capsule> hand{ball({0.01, 0.01, 0.07}, 0.01), ball({0.04, -0.01, 0.03}, 0.01),
                                  ball({-0.041, 0, 0.03}, 0.01)};
  const std::vector<Vector3d> places = touched_places(kBlock, kBlock, hand);
  REQUIRE(places.size() == 2);
  // With samples 2 mm apart, one is this near to the touching point of the ball.
  const double near = tolerance(0.0015, "m; samples 2 mm apart in a triangle");
  for (const Vector3d& truth : {Vector3d(0.01, 0.01, 0.06), Vector3d(0.03, -0.01, 0.03)}) {
    CHECK(std::any_of(places.begin(), places.end(),
                      [&](const Vector3d& place) { return (place - truth).norm() <= near; }));
  }
  CHECK(touched_places(kBlock, kBlock, {}).empty());
  CHECK(touched_places(kBlock, kBlock, std::vector{ball({0, 0, 0.0706}, 0.01)}).empty());
  CHECK(touched_places(kBlock, kBlock, std::vector{ball({0, 0, 0.0704}, 0.01)}).size() == 1);
}

TEST_CASE("places are those of the skin at rest, and the one that moves farthest comes first",
          "[score]") {
  SurfaceMesh pressed = kBlock;
  for (int v = 0; v < pressed.vertex_count(); ++v) {
    if (pressed.vertices(2, v) > 0.05)
      pressed.vertices(2, v) -= 0.01 + 0.1 * pressed.vertices(0, v);
  }
  // The top sinks by 10 mm in the middle and is inclined by 1 : 10.
  const auto lies_on = [](double x) {
    const Vector3d on(x, 0, 0.05 - 0.1 * x), normal = Vector3d(0.1, 0, 1).normalized();
    return ball(on + 0.008 * normal, 0.008);
  };
  const std::vector<Vector3d> places =
      touched_places(kBlock, pressed, std::vector{lies_on(-0.02), lies_on(0.02)});
  REQUIRE(places.size() == 2);
  const double near = tolerance(0.0015, "m; samples 2 mm apart in a triangle");
  CHECK((places[0] - Vector3d(0.02, 0, 0.06)).norm() <= near);   // 12 mm
  CHECK((places[1] - Vector3d(-0.02, 0, 0.06)).norm() <= near);  // 8 mm
}

TEST_CASE("one long touch is covered by places of 10 mm radius", "[score]") {
  // A stick that lies along the top of a bar with vertices 2 mm apart.
  constexpr int kParts = 40;
  SurfaceMesh bar;
  bar.vertices.resize(3, 2 * (kParts + 1));
  bar.triangles.resize(3, 2 * kParts);
  for (int i = 0; i <= kParts; ++i) {
    bar.vertices.col(2 * i) << 0.002 * i, -0.003, 0;
    bar.vertices.col(2 * i + 1) << 0.002 * i, 0.003, 0;
    if (i == kParts) break;
    bar.triangles.col(2 * i) << 2 * i, 2 * i + 2, 2 * i + 1;
    bar.triangles.col(2 * i + 1) << 2 * i + 1, 2 * i + 2, 2 * i + 3;
  }
  const std::vector<Capsule> stick{{{-0.01, 0, 0.005}, {0.09, 0, 0.005}, 0.005, 0.005}};
  const std::vector<Vector3d> places = touched_places(bar, bar, stick);
  CHECK(places.size() >= 4);  // 80 mm in parts of 20
  CHECK(places.size() <= 8);  // no two of them nearer than 10 mm
  for (double x = 0; x <= 0.08; x += 0.002) {
    INFO("x " << x);
    CHECK(std::any_of(places.begin(), places.end(), [&](const Vector3d& place) {
      return (place - Vector3d(x, 0, 0)).norm() <= kTouchedPlace + 0.002;
    }));
  }
}

TEST_CASE("a skin of other triangles is refused", "[score][errors]") {
  SurfaceMesh other = kBlock;
  other.triangles.conservativeResize(3, 11);
  CHECK_THROWS_AS(touched_places(kBlock, other, {}), ContractViolation);
}

}  // namespace
}  // namespace palpable
