#include "palpable/common/geometry/surface_distance.h"

#include "tests/support/test.h"

#include <cmath>
#include <limits>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

Vector3d some_point(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  const double x = uniform(random), y = uniform(random);
  return {x, y, uniform(random)};
}

TEST_CASE("the distance to a box is the closed form's, inside and outside, its normal the slope",
          "[geometry]") {
  const Vector3d half(1.0, 0.5, 0.25);
  const SurfaceDistance field(box_surface(-half, half));
  auto random = test::random_case(3);
  for (int i = 0; i < 300; ++i) {
    const Vector3d x = some_point(random, 1.5);
    const Vector3d q = x.cwiseAbs() - half;
    const double exact = q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
    const NearestOnSurface found = field.nearest(x);
    CHECK(std::abs(found.distance - exact) <= tolerance(1e-12, "rounding"));
    CHECK(std::abs(found.weights.sum() - 1.0) <= tolerance(1e-12, "rounding"));
    // A step along the normal changes the distance by the step's length.
    CHECK(std::abs(field.nearest(x + 1e-6 * found.normal).distance - exact - 1e-6) <=
          tolerance(1e-11, "rounding of differences"));
  }
}

TEST_CASE("the tree finds the same point as a search of all triangles", "[geometry]") {
  const SurfaceMesh sphere = sphere_surface({0.1, 0.2, 0.3}, 0.5, 3);
  const SurfaceDistance field(sphere);
  auto random = test::random_case(4);
  for (int i = 0; i < 100; ++i) {
    const Vector3d x = some_point(random, 1.0);
    double nearest = std::numeric_limits<double>::infinity();
    for (int t = 0; t < sphere.triangle_count(); ++t) {
      const auto c = sphere.triangles.col(t);
      const Vector3d weights = nearest_weights(sphere.vertices.col(c[0]), sphere.vertices.col(c[1]),
                                               sphere.vertices.col(c[2]), x);
      nearest = std::min(nearest, (x - sphere.vertices(Eigen::all, c) * weights).norm());
    }
    const NearestOnSurface found = field.nearest(x);
    CHECK(std::abs(std::abs(found.distance) - nearest) <= tolerance(1e-12, "rounding"));
    CHECK((found.distance < 0) == ((x - Vector3d(0.1, 0.2, 0.3)).norm() < 0.497));
  }
}

TEST_CASE("faces perpendicular to the wanted direction can be excluded", "[geometry]") {
  const SurfaceDistance field(box_surface({0, 0, 0}, {1, 1, 1}));
  // Nearest to the side x = 1, whose normal is perpendicular to z.
  const Vector3d x(0.99, 0.5, 0.9);
  CHECK(field.nearest_facing(x, {0, 0, 2}).point.x() == Approx(1.0));
  const NearestOnSurface top = field.nearest_facing(x, {0, 0, 2}, 0.1);
  CHECK((top.point - Vector3d(0.99, 0.5, 1.0)).norm() <= tolerance(1e-12, "rounding"));
  CHECK(top.distance == Approx(-0.1));
}

TEST_CASE("the sign is right beside a sharp corner", "[geometry]") {
  // Beyond the corner of a thin wedge the face normals alone disagree about the side.
  SurfaceMesh wedge;
  wedge.vertices =
      (Eigen::Matrix<double, 3, 4>() << 0, 1, 1, 1, 0, 0.1, -0.1, 0, 0, 0, 0, 0.05).finished();
  wedge.triangles = (Eigen::Matrix<int, 3, 4>() << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3).finished();
  if (enclosed_volume(wedge) < 0) wedge.triangles.row(1).swap(wedge.triangles.row(2));
  const SurfaceDistance field(wedge);
  for (const double y : {-0.1, -0.01, 0.0, 0.01, 0.1}) {
    for (const double z : {-0.1, 0.0, 0.02}) { CHECK(field.nearest({-0.05, y, z}).distance > 0.0); }
  }
  CHECK(field.nearest({0.9, 0.0, 0.01}).distance < 0.0);
}

}  // namespace
}  // namespace palpable
