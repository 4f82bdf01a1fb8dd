#include "palpable/common/geometry/surface_mesh.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <numbers>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

SurfaceMesh brick() { return box_surface({1, 2, 3}, {2, 4, 7}); }  // 1 x 2 x 4, off the origin

TEST_CASE("a box and a sphere are watertight", "[geometry]") {
  CHECK(check_watertight(brick()).describe() == "watertight");
  CHECK(check_watertight(sphere_surface({1, 0, 0}, 2.0, 3)).watertight());
}

TEST_CASE("each kind of defect is found, counted and located", "[geometry][errors]") {
  SurfaceMesh mesh = brick();
  SECTION("a missing triangle leaves three open edges") {
    mesh.triangles = mesh.triangles.leftCols(11).eval();
    const WatertightReport report = check_watertight(mesh);
    CHECK(report.open_edges == 3);
    CHECK_FALSE(report.watertight());
    CHECK(report.describe().find("3 open edges; the first at (") != std::string::npos);
  }
  SECTION("a triangle twice makes three edges crowded") {
    mesh.triangles.conservativeResize(3, 13);
    mesh.triangles.col(12) = mesh.triangles.col(0);
    CHECK(check_watertight(mesh).crowded_edges == 3);
  }
  SECTION("a turned triangle disagrees with three neighbours") {
    std::swap(mesh.triangles(0, 4), mesh.triangles(1, 4));
    CHECK(check_watertight(mesh).flipped_edges == 3);
  }
  SECTION("all triangles turned face inwards") {
    mesh.triangles.row(0).swap(mesh.triangles.row(1));
    const WatertightReport report = check_watertight(mesh);
    CHECK(report.inside_out);
    CHECK(report.describe().find("inwards") != std::string::npos);
  }
  SECTION("an index out of range") {
    mesh.triangles(2, 7) = 8;
    CHECK(check_watertight(mesh).bad_triangles == 1);
  }
  SECTION("a vertex that is not a number") {
    mesh.vertices(1, 3) = NAN;
    CHECK(check_watertight(mesh).bad_triangles > 0);
  }
  SECTION("no triangle at all") { CHECK_FALSE(check_watertight(SurfaceMesh{}).watertight()); }
}

TEST_CASE("volume, centroid and areas of a box are the closed forms", "[geometry]") {
  const double rounding = tolerance(1e-13, "a dozen products of numbers below 30");
  CHECK(enclosed_volume(brick()) == Approx(8.0).margin(rounding));
  CHECK((enclosed_centroid(brick()) - Vector3d(1.5, 3, 5)).norm() <= rounding);
  CHECK(vertex_areas(brick()).sum() == Approx(2.0 * (1 * 2 + 2 * 4 + 4 * 1)).margin(rounding));
}

TEST_CASE("a subdivided sphere approaches the ball's volume with second order", "[geometry]") {
  const double ball = 4.0 / 3.0 * std::numbers::pi * 8.0;
  const auto error = [&](int n) {
    return ball - enclosed_volume(sphere_surface({5, -1, 0}, 2.0, n));
  };
  const double order = std::log2(error(3) / error(4));  // the edge halves with each subdivision
  CHECK(order == Approx(2.0).margin(tolerance(0.02, "next term of the expansion in the edge")));
}

TEST_CASE("corners that coincide become one vertex and unused ones go", "[geometry]") {
  SurfaceMesh corners;  // each triangle has corners of its own, as in STL
  const SurfaceMesh box = brick();
  corners.vertices.resize(3, 37);
  corners.triangles.resize(3, 12);
  corners.vertices.col(36) = Vector3d(9, 9, 9);
  for (int i = 0; i < 36; ++i) {
    corners.vertices.col(i) = box.vertices.col(box.triangles(i % 3, i / 3));
    corners.triangles(i % 3, i / 3) = i;
  }
  const SurfaceMesh merged = merge_equal_vertices(corners);
  CHECK(merged.vertex_count() == 8);
  CHECK(check_watertight(merged).watertight());
  CHECK(enclosed_volume(merged) == enclosed_volume(corners));
}

TEST_CASE("normals of a sphere point away from its centre and take no memory",
          "[geometry][frame loop]") {
  const Vector3d centre(0.5, 1, -2);
  const SurfaceMesh sphere = sphere_surface(centre, 0.7, 3);
  const Eigen::Matrix3Xf vertices = sphere.vertices.cast<float>();
  Eigen::Matrix3Xf normals(3, vertices.cols());
  CHECK(test::allocations_during([&] { vertex_normals(vertices, sphere.triangles, normals); }) ==
        0);
  for (int i = 0; i < sphere.vertex_count(); ++i) {
    const Vector3d radial = (sphere.vertices.col(i) - centre).normalized();
    CHECK(normals.col(i).cast<double>().dot(radial) >
          1.0 - tolerance(2e-4, "facets of 8 degrees: half the square of their scatter"));
  }
}

TEST_CASE("a patch grows ring by ring along edges", "[geometry]") {
  const auto neighbours = vertex_neighbours(sphere_surface({0, 0, 0}, 1.0, 2));
  CHECK(graph_patch(neighbours, 0, 0) == std::vector<int>{0});
  CHECK(graph_patch(neighbours, 0, 1).size() == 6);       // a corner of the icosahedron has 5
  CHECK(graph_patch(neighbours, 0, 2).size() == 6 + 10);  // and ten behind them
  CHECK(graph_patch(neighbours, 0, 100).size() == neighbours.size());
}

TEST_CASE("the mean edge of a box counts its twelve edges and the diagonals of its faces",
          "[geometry]") {
  const double sum = 4 * (3 + 4 + 12) + 2 * (5 + std::sqrt(153.0) + std::sqrt(160.0));
  CHECK(mean_edge_length(box_surface({0, 0, 0}, {3, 4, 12})) == Approx(sum / 18));
  CHECK_THROWS_AS(mean_edge_length(SurfaceMesh{}), ContractViolation);
}

}  // namespace

}  // namespace palpable
