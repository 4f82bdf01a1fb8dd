#include "palpable/common/geometry/skin_points.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "tests/support/test.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::tolerance;

TEST_CASE("every position on the skin is near a contact point, and no two points coincide",
          "[geometry][skin points]") {
  const SurfaceMesh sphere = sphere_surface(Vector3d::Zero(), 0.05, 2);  // edges of 14 mm
  const std::vector<std::uint8_t> fixed(static_cast<std::size_t>(sphere.vertex_count()), 0);
  const auto points = skin_points(sphere, fixed, 0.004);
  const Eigen::Matrix3Xf X = sphere.vertices.cast<float>();
  std::vector<Vector3f> at;
  for (const SkinPoint& point : points) {
    CHECK(point.weights[0] + point.weights[1] + point.weights[2] == Approx(1));
    at.push_back(point.at(X));
  }
  for (std::size_t i = 0; i < at.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) REQUIRE((at[i] - at[j]).norm() > 1e-3f);
  }
  auto random = test::random_case(1);
  std::uniform_real_distribution<float> share(0, 1);
  float farthest = 0;
  for (int t = 0; t < sphere.triangle_count(); t += 3) {
    float a = share(random), b = share(random);
    if (a + b > 1) a = 1 - a, b = 1 - b;
    const Eigen::Vector3i c = sphere.triangles.col(t);
    const Vector3f x = (1 - a - b) * X.col(c[0]) + a * X.col(c[1]) + b * X.col(c[2]);
    float nearest = std::numeric_limits<float>::infinity();
    for (const Vector3f& y : at) nearest = std::min(nearest, (x - y).norm());
    farthest = std::max(farthest, nearest);
  }
  CHECK(farthest < tolerance(0.0025f, "0.58 spacings in an equilateral triangle, these are not"));
}

TEST_CASE("a coarse spacing leaves the vertices, and what is fixed is left out",
          "[geometry][skin points]") {
  const SurfaceMesh box = box_surface({0, 0, 0}, {0.1, 0.1, 0.1});
  std::vector<std::uint8_t> fixed(static_cast<std::size_t>(box.vertex_count()), 0);
  CHECK(skin_points(box, fixed, 1.0).size() == 8);
  for (std::size_t k = 0; k < fixed.size(); ++k) {
    fixed[k] = box.vertices(2, static_cast<Eigen::Index>(k)) == 0;
  }
  CHECK(skin_points(box, fixed, 1.0).size() == 4);
  const Eigen::Matrix3Xf X = box.vertices.cast<float>();
  int low = 0;
  for (const SkinPoint& point : skin_points(box, fixed, 0.02)) {
    CHECK(point.at(X).z() > 0);
    low += point.at(X).z() < 0.03f ? 1 : 0;
  }
  CHECK(low > 10);  // a wall moves down to its fixed edge
  CHECK_THROWS_AS(skin_points(box, fixed, 0), ContractViolation);
  CHECK_THROWS_AS(skin_points(box, {}, 0.01), ContractViolation);
}

}  // namespace

}  // namespace palpable
