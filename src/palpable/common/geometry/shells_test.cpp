#include "palpable/common/geometry/shells.h"

#include "tests/support/meshes.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Vector3d;
using test::flipped;
using test::joined;
using test::tolerance;

SurfaceMesh box(double low, double high) {
  return box_surface(Vector3d::Constant(low), Vector3d::Constant(high));
}

TEST_CASE("a surface is divided into its shells", "[geometry][shells]") {
  CHECK(shells_of(SurfaceMesh{}).empty());
  const SurfaceMesh both = joined(box(0, 1), sphere_surface({3, 0, 0}, 1, 1));
  const std::vector<std::vector<int>> shells = shells_of(both);
  REQUIRE(shells.size() == 2);
  CHECK(shells[0].size() == 12);
  CHECK(shells[1].size() == 80);
  const SurfaceMesh sphere = surface_of(both, shells[1]);
  CHECK(sphere.vertices == sphere_surface({3, 0, 0}, 1, 1).vertices);
  CHECK(check_watertight(sphere).watertight());
}

TEST_CASE("a surface winds once around points that it encloses", "[geometry][shells]") {
  const SurfaceMesh surface = joined(box(0, 1), flipped(box(0.25, 0.75)));
  const auto is = [&](const Vector3d& point, double wanted) {
    INFO(point.transpose());
    CHECK(std::abs(winding_number(surface, point) - wanted) <= tolerance(1e-12, "rounding"));
  };
  is({0.1, 0.2, 0.5}, 1.0);  // in the material
  is({0.5, 0.5, 0.5}, 0.0);  // in the cavity
  is({1.5, 0.5, 0.5}, 0.0);  // outside
  CHECK(std::abs(winding_number(surface, {0.5, 0.5, 0.75 - 1e-9})) <=
        tolerance(1e-7, "a wall 1e-9 away, whose corners are rounded to 1e-16"));
  CHECK(std::abs(winding_number(flipped(box(0, 1)), {0.5, 0.5, 0.5}) + 1.0) <=
        tolerance(1e-12, "rounding"));
}

TEST_CASE("shells that form a solid are distinguished from those that do not",
          "[geometry][shells]") {
  CHECK(misplaced_shell(box(0, 1)).empty());
  CHECK(misplaced_shell(joined(box(0, 1), box(2, 3))).empty());
  const SurfaceMesh hollow = joined(box(0, 1), flipped(box(0.2, 0.8)));
  CHECK(misplaced_shell(hollow).empty());
  CHECK(misplaced_shell(joined(hollow, box(0.4, 0.6))).empty());  // an island in the cavity

  CHECK_THAT(misplaced_shell(joined(box(0, 1), box(0.2, 0.8))),
             Contains("of 2 closed shells the one at (0.2, ") && Contains("12 triangles") &&
                 Contains("faces outwards like it"));
  CHECK_THAT(misplaced_shell(joined(box(0, 1), flipped(box(2, 2.5)))),
             Contains("faces inwards but lies in no other"));
  CHECK_THAT(misplaced_shell(joined(hollow, flipped(box(0.4, 0.6)))),
             Contains("faces inwards but lies in no other"));
}

TEST_CASE("for each cavity a point in it is found", "[geometry][shells]") {
  CHECK(points_in_cavities(box(0, 1)).empty());
  CHECK(points_in_cavities(joined(box(0, 1), box(2, 3))).empty());
  // A cavity around an island, and a small cavity beside it.
  SurfaceMesh surface =
      joined(sphere_surface({0, 0, 0}, 1.0, 2), flipped(sphere_surface({0.1, 0, 0}, 0.6, 2)));
  surface = joined(surface, sphere_surface({0.1, 0, 0}, 0.5, 2));
  surface = joined(surface, flipped(sphere_surface({-0.75, 0, 0}, 0.1, 1)));
  const std::vector<Vector3d> points = points_in_cavities(surface);
  REQUIRE(points.size() == 2);
  const double r = (points[0] - Vector3d(0.1, 0, 0)).norm();
  CHECK((r > 0.5 && r < 0.6));
  CHECK((points[1] - Vector3d(-0.75, 0, 0)).norm() < 0.1);
  for (const Vector3d& point : points) {
    CHECK(std::abs(winding_number(surface, point)) <= tolerance(1e-12, "rounding"));
  }
}

}  // namespace
}  // namespace palpable
