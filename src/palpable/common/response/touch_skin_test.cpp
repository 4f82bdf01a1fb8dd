#include "palpable/common/response/touch_skin.h"

#include "palpable/common/geometry/surface_distance.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using test::tolerance;

// A ball of radius 40 mm, with a fine and a coarse mesh.
struct Balls {
  SurfaceMesh fine = sphere_surface({0, 0, 0.04}, 0.04, 4);
  SurfaceMesh coarse = sphere_surface({0, 0, 0.04}, 0.04, 2);
  TouchTables tables = test::some_touch_tables(coarse, 1);
  std::vector<std::uint8_t> fixed =
      std::vector<std::uint8_t>(static_cast<std::size_t>(fine.vertex_count()), 0);

  Balls() {
    tables.point_spacing = 0.002;
    tables.coarse = {coarse,
                     std::vector<std::uint8_t>(static_cast<std::size_t>(coarse.vertex_count()), 0)};
  }
  [[nodiscard]] TouchSkin skin() const { return {fine, fixed, tables}; }
};

// (3 x V) the displacement by a rotation about the axis (1, 2, 3) and a translation.
Matrix3Xf turned(const SurfaceMesh& surface, double angle) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, Vector3d(1, 2, 3).normalized()).matrix();
  const Eigen::Matrix3Xd moved = (R * surface.vertices).colwise() + Vector3d(0.01, 0.02, 0.03);
  return (moved - surface.vertices).cast<float>();
}

TEST_CASE("a carried skin is where it was while the coarser one rests", "[contact][carried]") {
  const Balls balls;
  TouchSkin skin = balls.skin();
  CHECK(skin.is_carried());
  Matrix3Xf x(3, balls.fine.vertex_count());
  skin.update_normals(Matrix3Xf(3, 0));
  skin.place(Matrix3Xf(3, 0), x);
  CHECK(x == balls.fine.vertices.cast<float>());
  const Matrix3Xf zero = Matrix3Xf::Zero(3, balls.coarse.vertex_count());
  skin.update_normals(zero);
  skin.place(zero, x);
  CHECK(x == balls.fine.vertices.cast<float>());
  // Contact points are the fine skin's.
  CHECK(skin.points().size() >= static_cast<std::size_t>(balls.fine.vertex_count()));
  const SurfaceDistance surface(balls.fine);
  for (Eigen::Index p = 0; p < skin.places().cols(); ++p) {
    CHECK(std::abs(surface.nearest(skin.places().col(p).cast<double>()).distance) <
          tolerance(1e-8, "m: single precision"));
  }
}

TEST_CASE("a skin that is carried turns with the one that carries it", "[contact][carried]") {
  const Balls balls;
  TouchSkin skin = balls.skin();
  const Matrix3Xf u = turned(balls.coarse, 0.5);
  const Matrix3Xf wanted = balls.fine.vertices.cast<float>() + turned(balls.fine, 0.5);
  Matrix3Xf x(3, balls.fine.vertex_count());
  skin.update_normals(u);
  skin.place(u, x);
  // Triangles of 14 mm lie up to 0.7 mm inside the ball; the part of that height beside the
  // interpolated normal is not turned.
  const double off = (x - wanted).colwise().norm().maxCoeff();
  CHECK(off < tolerance(1e-4,
                        "m: the normals of corners, 7 degrees from those of the ball, times "
                        "the height and the angle"));
  // With the normals at rest the heights are not turned, and the error is larger.
  skin.update_normals(Matrix3Xf(3, 0));
  skin.place(u, x);
  CHECK((x - wanted).colwise().norm().maxCoeff() > 2 * off);
}

TEST_CASE("a point of a thin part is attached to its own side of the coarse skin",
          "[contact][carried]") {
  // A coarse lens, and a fine one so thin that each of its sides lies a little beyond the middle:
  // the opposite side of the coarse lens is nearer.
  SurfaceMesh coarse = sphere_surface({0, 0, 0}, 0.03, 3),
              fine = sphere_surface({0, 0, 0}, 0.03, 4);
  coarse.vertices.row(2) *= 0.05;
  fine.vertices.row(2) *= -0.0002;
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, fine.vertex_count());
  const SurfaceMesh& ball = sphere_surface({0, 0, 0}, 1, 4);
  normals.row(2) = ball.vertices.row(2).array().sign().matrix();
  const Carrier carrier(coarse);
  int tested = 0;
  for (int v = 0; v < fine.vertex_count(); ++v) {
    if (std::abs(ball.vertices(2, v)) < 0.3) continue;
    const SkinPoint on = carrier.stand(fine.vertices.col(v), normals.col(v)).on;
    double z = 0;
    for (int k = 0; k < 3; ++k) {
      z += static_cast<double>(on.weights[k]) *
           coarse.vertices(2, on.corners[static_cast<std::size_t>(k)]);
    }
    CHECK(z * ball.vertices(2, v) > 0);
    ++tested;
  }
  CHECK(tested > 1000);
}

TEST_CASE("a quantity at the vertices of a coarser skin is interpolated on the fine one",
          "[contact][carried]") {
  const Balls balls;
  const TouchSkin skin = balls.skin();
  std::vector<float> of_vertices;
  for (const auto& x : balls.coarse.vertices.colwise()) {
    of_vertices.push_back(static_cast<float>(x[0]));
    of_vertices.push_back(static_cast<float>(2 * x[2]));
  }
  std::vector<float> spread(2 * static_cast<std::size_t>(balls.fine.vertex_count()));
  skin.spread(of_vertices, 2, spread);
  for (int v = 0; v < balls.fine.vertex_count(); ++v) {
    const auto k = 2 * static_cast<std::size_t>(v);
    CHECK(std::abs(spread[k] - balls.fine.vertices(0, v)) < tolerance(8e-4, "m: the height"));
    CHECK(std::abs(spread[k + 1] - 2 * balls.fine.vertices(2, v)) <
          tolerance(16e-4, "m: twice it"));
  }
}

TEST_CASE("contact points on held triangles of the coarser skin are left out",
          "[contact][carried]") {
  Balls balls;
  const std::size_t all = balls.skin().points().size();
  std::vector<std::uint8_t>& fixed = balls.tables.coarse->fixed;
  for (int v = 0; v < balls.coarse.vertex_count(); ++v) {
    fixed[static_cast<std::size_t>(v)] = balls.coarse.vertices(2, v) < 0.03 ? 1 : 0;
  }
  const TouchSkin skin = balls.skin();
  CHECK(skin.points().size() < all);
  for (const SkinPoint& point : skin.points()) {
    CHECK(std::any_of(point.corners.begin(), point.corners.end(),
                      [&](int v) { return fixed[static_cast<std::size_t>(v)] == 0; }));
  }
}

}  // namespace

}  // namespace palpable
