#include "palpable/common/geometry/surface_repair.h"

#include "palpable/common/geometry/shells.h"
#include "tests/support/meshes.h"
#include "tests/support/test.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Catch::Contains;

void turn(SurfaceMesh& surface, int triangle) {
  std::swap(surface.triangles(1, triangle), surface.triangles(2, triangle));
}

bool same(const SurfaceMesh& a, const SurfaceMesh& b) {
  return a.vertices == b.vertices && a.triangles == b.triangles;
}

// Whether the faces are the same, whichever corner of each comes first.
bool same_faces(const SurfaceMesh& a, const SurfaceMesh& b) {
  if (a.vertices != b.vertices || a.triangles.cols() != b.triangles.cols()) return false;
  for (Eigen::Index t = 0; t < a.triangles.cols(); ++t) {
    const Eigen::Vector3i one = a.triangles.col(t), other = b.triangles.col(t);
    const auto turned = [&](int by) {
      return one == Eigen::Vector3i(other[by % 3], other[(by + 1) % 3], other[(by + 2) % 3]);
    };
    if (!turned(0) && !turned(1) && !turned(2)) return false;
  }
  return true;
}

// Each triangle with corners of its own, as an STL has them, each moved by up to `amount` along
// each axis.
SurfaceMesh shaken(const SurfaceMesh& surface, double amount, unsigned seed) {
  auto random = test::random_case(seed);
  SurfaceMesh soup;
  soup.vertices.resize(3, 3 * surface.triangles.cols());
  soup.triangles.resize(3, surface.triangles.cols());
  for (int t = 0; t < surface.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int v = 3 * t + k;
      soup.triangles(k, t) = v;
      soup.vertices.col(v) = surface.vertices.col(surface.triangles(k, t));
      for (double& x : soup.vertices.col(v)) {
        x += amount * (static_cast<double>(random() % 2001) / 1000.0 - 1.0);
      }
    }
  }
  return soup;
}

TEST_CASE("a clean surface is not changed by repairs", "[geometry][repair]") {
  const SurfaceMesh ball = sphere_surface({1, 2, 3}, 0.5, 2);
  const SurfaceMesh hollow = test::joined(ball, test::flipped(sphere_surface({1, 2, 3}, 0.2, 1)));
  const SurfaceMesh two = test::joined(ball, sphere_surface({4, 2, 3}, 0.2, 1));
  // As it is refused today: within another one and facing outwards like it.
  const SurfaceMesh nested = test::joined(ball, sphere_surface({1, 2, 3}, 0.2, 1));
  for (const SurfaceMesh& clean : {ball, hollow, two, nested, box_surface({0, 0, 0}, {1, 2, 3})}) {
    SurfaceMesh surface = clean;
    CHECK(repair_surface(surface).describe().empty());
    CHECK(same(surface, clean));
  }
}

TEST_CASE("faces wound the other way are turned, and their volume is said", "[geometry][repair]") {
  const SurfaceMesh ball = sphere_surface({0, 0, 0}, 1, 2);
  SurfaceMesh every_second = ball;
  for (int t = 0; t < ball.triangle_count(); t += 2) turn(every_second, t);
  SurfaceMesh one = ball;
  turn(one, 17);
  for (SurfaceMesh surface :
       {every_second, test::flipped(every_second), test::flipped(ball), one}) {
    const SurfaceRepair repair = repair_surface(surface);
    CHECK(repair.turned > 0);
    CHECK(same_faces(surface, ball));
    CHECK(repair.volume == enclosed_volume(ball));
  }
  const SurfaceRepair repair = repair_surface(one);
  CHECK(repair.describe() ==
        fmt::format("repaired: 1 of 320 faces turned, which now enclose a volume of {:.6g} (in the "
                    "file's lengths)",
                    enclosed_volume(ball)));
}

TEST_CASE("shells are turned as they lie in each other", "[geometry][repair]") {
  const SurfaceMesh outer = sphere_surface({0, 0, 0}, 1, 2),
                    small = sphere_surface({0, 0, 0}, 0.5, 1);
  const SurfaceMesh hollow = test::joined(outer, test::flipped(small));
  // The whole file inside out, and each second of its faces.
  SurfaceMesh all = test::flipped(hollow);
  CHECK(repair_surface(all).turned == hollow.triangle_count());
  CHECK(same_faces(all, hollow));
  SurfaceMesh mixed = hollow;
  for (int t = 0; t < mixed.triangle_count(); t += 2) turn(mixed, t);
  repair_surface(mixed);
  CHECK(same_faces(mixed, hollow));
  // Of two balls beside each other one is inside out; the whole encloses a positive volume.
  const SurfaceMesh beside = test::joined(outer, sphere_surface({3, 0, 0}, 0.5, 1));
  SurfaceMesh half = test::joined(outer, test::flipped(sphere_surface({3, 0, 0}, 0.5, 1)));
  CHECK(repair_surface(half).turned == 80);
  CHECK(same_faces(half, beside));
  // Two solids in each other stay what they are, whichever way the file winds: not ours to decide.
  SurfaceMesh nested = test::flipped(test::joined(outer, small));
  repair_surface(nested);
  CHECK_THAT(misplaced_shell(nested), Contains("faces outwards like it"));
}

TEST_CASE("vertices that differ by less than 1e-4 of an edge are welded, and the way is said",
          "[geometry][repair]") {
  const SurfaceMesh ball = sphere_surface({0, 0, 0}, 1, 2);
  const double edge = mean_edge_length(ball);
  for (unsigned seed = 0; seed < 5; ++seed) {
    INFO("seed " << seed);
    // Two corners are up to 2 sqrt(3) amounts apart: less than 1e-4 of the shortest edge.
    SurfaceMesh surface = shaken(ball, 2e-5 * edge, seed);
    CHECK_FALSE(check_watertight(surface).watertight());
    const SurfaceRepair repair = repair_surface(surface);
    CHECK(check_watertight(surface).describe() == "watertight");
    CHECK(surface.vertex_count() == ball.vertex_count());
    CHECK(repair.welded == 3 * ball.triangle_count() - ball.vertex_count());
    CHECK(repair.moved > 0.0);
    CHECK(repair.moved < 1e-4 * edge);
    CHECK_THAT(repair.describe(), Contains("798 vertices joined with others at most"));
    // Each vertex is off by at most `amount` along each axis.
    CHECK(std::abs(enclosed_volume(surface) - enclosed_volume(ball)) <
          1e-3 * enclosed_volume(ball));
    SurfaceMesh apart = shaken(ball, 1e-3 * edge, seed);
    repair_surface(apart);
    CHECK_FALSE(check_watertight(apart).watertight());
  }
  SurfaceMesh far = shaken(ball, 1e-5 * edge, 7);
  far.vertices.array() += 1e20;  // all corners fall on each other
  (void)repair_surface(far);
  CHECK(far.vertices.allFinite());
}

TEST_CASE("duplicate faces and triangles without area are left out, and counted",
          "[geometry][repair]") {
  const SurfaceMesh ball = sphere_surface({0, 0, 0}, 1, 1);
  SurfaceMesh surface = ball;
  surface.triangles.conservativeResize(3, 83);
  surface.triangles.col(80) = ball.triangles.col(5);
  surface.triangles.col(81) << ball.triangles(1, 7), ball.triangles(0, 7), ball.triangles(2, 7);
  surface.triangles.col(82) << 3, 3, 9;
  const SurfaceRepair repair = repair_surface(surface);
  CHECK(repair.duplicates == 2);
  CHECK(repair.collapsed == 1);
  CHECK(check_watertight(surface).watertight());
  CHECK(enclosed_volume(surface) == enclosed_volume(ball));
  // Both sides of each face, as a modeller of rooms exports them.
  SurfaceMesh sides = ball;
  sides.triangles.conservativeResize(3, 160);
  sides.triangles.rightCols(80) = test::flipped(ball).triangles;
  CHECK(repair_surface(sides).duplicates == 80);
  CHECK(enclosed_volume(sides) == enclosed_volume(ball));
}

// fTetWild#69, TetWild#41: what the solid is there is not for a repair to decide.
TEST_CASE("a wall between two solids, an edge of four faces and a hole stay, and wrap is named",
          "[geometry][repair]") {
  const SurfaceMesh low = box_surface({0, 0, 0}, {20, 20, 5}),
                    high = box_surface({0, 0, 5}, {20, 20, 10});
  const SurfaceMesh aside = box_surface({20, 20, 0}, {40, 40, 5});
  SurfaceMesh open = low;
  open.triangles.conservativeResize(3, 11);
  for (const SurfaceMesh& given : {merge_equal_vertices(test::joined(low, high)),
                                   merge_equal_vertices(test::joined(low, aside)), open}) {
    SurfaceMesh surface = given;
    CHECK(repair_surface(surface).describe().empty());
    CHECK(same(surface, given));
    CHECK_THAT(check_watertight(surface).describe(), Contains("'wrap' in a body's description"));
  }
}

TEST_CASE("a surface with a single side is left as it is", "[geometry][repair]") {
  // The projective plane of six vertices: closed, but neither side is outside.
  SurfaceMesh plane;
  plane.vertices = Eigen::Matrix3Xd(3, 6);
  plane.vertices << 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 2;
  plane.triangles = Eigen::Matrix3Xi(3, 10);
  plane.triangles << 0, 0, 0, 0, 0, 1, 1, 1, 2, 2,  //
      1, 1, 2, 3, 4, 2, 3, 4, 3, 3,                 //
      2, 3, 4, 5, 5, 5, 4, 5, 4, 5;
  const SurfaceMesh given = plane;
  CHECK(repair_surface(plane).turned == 0);
  CHECK(same(plane, given));
}

}  // namespace
}  // namespace palpable
