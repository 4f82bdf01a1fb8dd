#include "palpable/desk/score/skin_fit.h"

#include "tests/support/test.h"

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

TEST_CASE("the offset of balls of two sizes is the difference of the radii", "[score]") {
  const SurfaceMesh fine = sphere_surface({0, 0, 0.05}, 0.05, 4);
  CHECK(skin_offset(fine, fine) <= tolerance(1e-15, "rounding"));
  const SurfaceMesh larger = sphere_surface({0, 0, 0.05}, 0.052, 4);
  CHECK(skin_offset(fine, larger) == Approx(0.002).epsilon(tolerance(0.02, "chords of 4 mm")));
  CHECK(skin_offset(larger, fine) == skin_offset(fine, larger));
}

TEST_CASE("a shifted ball has half its shift as offset", "[score]") {
  // |cos| of a direction is 1/2 on average over a sphere.
  const SurfaceMesh ball = sphere_surface({0, 0, 0.05}, 0.05, 4);
  const SurfaceMesh beside = sphere_surface({0.004, 0, 0.05}, 0.05, 4);
  CHECK(skin_offset(ball, beside) == Approx(0.002).epsilon(tolerance(0.02, "chords of 4 mm")));
}

TEST_CASE("the offset of a coarse mesh of the same ball is that of its chords", "[score]") {
  // The middles of edges of 28 mm lie 28^2 / (8 * 50) = 2 mm inside.
  const double coarse = skin_offset(sphere_surface(Vector3d::Zero(), 0.05, 1),
                                    sphere_surface(Vector3d::Zero(), 0.05, 4));
  CHECK(coarse > 0.0005);
  CHECK(coarse < 0.0040);
}

TEST_CASE("a part that one skin lacks counts in both orders", "[score]") {
  const SurfaceMesh whole = box_surface({0, 0, 0}, {0.1, 0.1, 0.1});
  SurfaceMesh half = whole;  // its vertices all lie on the sides of the whole box
  for (int v = 0; v < half.vertex_count(); ++v) half.vertices(2, v) *= 0.5;
  const double offset = skin_offset(whole, half);
  CHECK(offset == Approx(0.025));  // half of the vertices are 50 mm off
  CHECK(skin_offset(half, whole) == offset);
}

}  // namespace
}  // namespace palpable
