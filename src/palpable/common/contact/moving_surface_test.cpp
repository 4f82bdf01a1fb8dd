#include "palpable/common/contact/moving_surface.h"

#include "palpable/common/geometry/surface_distance.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <random>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::tolerance;

// A flat bar with sharp rims: a flattened ball.
SurfaceMesh flat_bar() {
  SurfaceMesh bar = sphere_surface(Vector3d::Zero(), 1, 3);
  for (Eigen::Index v = 0; v < bar.vertices.cols(); ++v) {
    const Vector3d x = bar.vertices.col(v);
    bar.vertices.col(v) = Vector3d(0.10 * x.x(), 0.03 * x.y(), 0.01 * x.z());
  }
  return bar;
}

// The same bar, bent around the y axis.
Eigen::Matrix3Xf bent(const SurfaceMesh& bar, double curvature) {
  Eigen::Matrix3Xd x = bar.vertices;
  for (Eigen::Index v = 0; v < x.cols(); ++v) {
    const double angle = curvature * bar.vertices(0, v);
    const double radius = 1 / curvature - bar.vertices(2, v);
    x.col(v) = Vector3d(radius * std::sin(angle), bar.vertices(1, v),
                        1 / curvature - radius * std::cos(angle));
  }
  return x.cast<float>();
}

TEST_CASE("distances to a moved skin are those to a skin made in the same shape", "[contact]") {
  const SurfaceMesh bar = flat_bar();
  MovingSurface moving(bar);
  const Eigen::Matrix3Xf now = bent(bar, 6.0);
  moving.move(now);
  const SurfaceDistance exact(SurfaceMesh{now.cast<double>(), bar.triangles});
  auto random = test::random_case(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const double along = 0.11 * uniform(random), beside = 0.04 * uniform(random);
    const Vector3d x(along, beside, 0.010 + 0.035 * uniform(random));
    const NearestOnSurface wanted = exact.nearest(x);
    const auto found = moving.nearest(x.cast<float>(), 0.02f);
    if (std::abs(wanted.distance) > 0.0201) {
      CHECK_FALSE(found.has_value());
      continue;
    }
    if (std::abs(wanted.distance) > 0.0199) continue;
    REQUIRE(found.has_value());
    CHECK(std::abs(static_cast<double>(found->distance) - wanted.distance) <=
          tolerance(1e-6, "m: floats of 0.1 m"));
    CHECK(static_cast<double>(std::abs(found->weights.sum() - 1.0f)) <= tolerance(1e-5, "floats"));
    if (std::abs(wanted.distance) > 1e-4) {
      // Where two sides are equally near, either normal is right.
      const Vector3d step = x + 1e-5 * found->normal.cast<double>();
      CHECK(exact.nearest(step).distance - wanted.distance >
            1e-5 * (1 - tolerance(0.05, "its direction is a float's difference")));
    }
    CHECK(moving.may_be_within(x.cast<float>(),
                               static_cast<float>(std::abs(wanted.distance)) + 1e-5f));
    inside += wanted.distance < 0;
  }
  CHECK(inside > 100);
  CHECK(test::allocations_during([&] {
          moving.move(now);
          (void)moving.nearest(Vector3f(0.01f, 0.0f, 0.0f), 0.02f);
        }) == 0);
}

TEST_CASE("a query at NaN finds nothing", "[contact]") {
  const MovingSurface bar(flat_bar());
  CHECK_FALSE(bar.nearest(Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()), 0.1f));
}

TEST_CASE("a rounded skin has the curvature of the smooth surface, and sharp edges stay sharp",
          "[contact]") {
  const double radius = 0.03;
  const MovingSurface ball(sphere_surface(Vector3d::Zero(), radius, 3));
  auto random = test::random_case(7);
  std::uniform_real_distribution<float> uniform(-1, 1);
  RoundedSkin before;
  for (int i = 0; i < 200; ++i) {
    const Vector3f x =
        0.031f * Vector3f(uniform(random), uniform(random), uniform(random)).normalized();
    const auto found = ball.nearest(x, 0.005f);
    REQUIRE(found);
    const RoundedSkin skin = ball.rounded_at(*found);
    CHECK(skin.normal.dot(x.normalized()) > 1 - tolerance(1e-4, "0.8 degrees: the faces' are 3"));
    CHECK(skin.curvature.trace() ==
          Approx(2 / radius).epsilon(tolerance(0.15, "of triangles that differ")));
    CHECK((skin.curvature * skin.normal).norm() < tolerance(1e-3, "1/m: rounding"));
  }
  // A box: its faces are flat up to the edges.
  SurfaceMesh box;
  box.vertices.resize(3, 8);
  for (int v = 0; v < 8; ++v)
    box.vertices.col(v) << 0.01 * (v & 1), 0.01 * (v >> 1 & 1), 0.01 * (v >> 2);
  box.triangles.resize(3, 12);
  box.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      3, 2, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,               //
      1, 3, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  const MovingSurface corners(box);
  const auto found = corners.nearest(Vector3f(0.0095f, 0.004f, 0.0102f), 0.005f);
  REQUIRE(found);
  const RoundedSkin flat = corners.rounded_at(*found);
  CHECK((flat.normal - Vector3f::UnitZ()).norm() < tolerance(1e-6, "rounding"));
  CHECK(flat.curvature.norm() < tolerance(1e-3, "1/m: rounding"));
  // In front of an edge the normal is the direction from the nearest position.
  const auto beside = corners.nearest(Vector3f(0.011f, 0.005f, 0.011f), 0.005f);
  REQUIRE(beside);
  CHECK(corners.rounded_at(*beside).normal == beside->normal);
}

}  // namespace
}  // namespace palpable
