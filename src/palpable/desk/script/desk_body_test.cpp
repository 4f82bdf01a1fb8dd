#include "palpable/desk/script/desk_body.h"

#include "tests/support/test.h"

#include <Eigen/Geometry>

using namespace palpable;
using palpable::test::random_case;
using palpable::test::tolerance;

TEST_CASE("no point of a surface is farther from its samples than the spacing", "[script]") {
  const SurfaceMesh ball = sphere_surface({0.1, -0.2, 0.3}, 0.05, 1);
  const SurfacePoints samples = sample_surface(ball, 0.004);
  CHECK((samples.points.leftCols(ball.vertex_count()) - ball.vertices).norm() == 0.0);
  auto random = random_case(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int t = 0; t < ball.triangle_count(); ++t) {
    double a = uniform(random), b = uniform(random);
    if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
    const Eigen::Vector3i corner = ball.triangles.col(t);
    const Eigen::Vector3d x = (1.0 - a - b) * ball.vertices.col(corner[0]) +
                              a * ball.vertices.col(corner[1]) + b * ball.vertices.col(corner[2]);
    CHECK((samples.points.colwise() - x).colwise().norm().minCoeff() <= 0.004);
  }
}

TEST_CASE("samples have the direction into the body", "[script]") {
  const Eigen::Vector3d middle(0.1, -0.2, 0.3);
  const SurfacePoints samples = sample_surface(sphere_surface(middle, 0.05, 2), 0.01);
  for (Eigen::Index i = 0; i < samples.points.cols(); ++i)
    CHECK(samples.inwards.col(i).dot((middle - samples.points.col(i)).normalized()) > 0.95);
  Rigid3 move = Rigid3::Identity();
  move.linear() = Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  move.translation() << 1, 2, 3;
  const SurfacePoints moved = transformed(samples, move);
  CHECK((moved.points.col(5) - move * samples.points.col(5)).norm() <=
        tolerance(1e-15, "rounding"));
  CHECK((moved.inwards.col(5) - move.linear() * samples.inwards.col(5)).norm() <=
        tolerance(1e-15, "rounding"));
}

TEST_CASE("the nearest site is found; a body without sites has none", "[script]") {
  DeskBody body;
  body.surface = box_surface({0, 0, 0}, {1, 1, 1});
  CHECK(nearest_site(body, {0, 0, 0}) == -1);
  body.site_vertices = {0, 7};
  const Eigen::Vector3d second = body.surface.vertices.col(7);
  CHECK(nearest_site(body, second) == 1);
}
