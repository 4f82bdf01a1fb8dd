#include "palpable/bake/mesh/mesh_limits.h"

#include "palpable/bake/mesh/remesh.h"
#include "palpable/bake/mesh/tetrahedralise.h"
#include "palpable/common/base/error.h"
#include "tests/support/meshes.h"
#include "tests/support/test.h"

#include <cmath>
#include <string>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Vector3d;

TEST_CASE("the number of nodes is known well enough before meshing", "[mesh][limits]") {
  const SurfaceMesh ball = sphere_surface({0, 0, 0}, 0.05, 4);
  const SurfaceMesh plate = box_surface({0, 0, 0}, {0.2, 0.1, 0.02});
  for (const SurfaceMesh* surface : {&ball, &plate}) {
    for (const double edge : {0.01, 0.006}) {
      const SurfaceMesh fine = remesh_surface(*surface, edge, "test");
      const int nodes = tetrahedralise(fine, "test").node_count();
      const double guess = estimated_nodes(*surface, edge, edge);
      INFO("edge " << edge << ": " << nodes << " nodes, estimated " << guess);
      CHECK(guess > 0.8 * nodes);
      CHECK(guess < 1.7 * nodes);  // a plate of three layers has few nodes inside
    }
  }
}

TEST_CASE("one vertex far off all others is named", "[mesh][limits]") {
  SurfaceMesh ball = sphere_surface({5, 5, 5}, 40, 2);
  CHECK_NOTHROW(require_no_stray(ball.vertices, "ball"));
  ball.vertices.col(7) = Vector3d(5, 5, 30000);  // a long needle
  CHECK_NOTHROW(require_no_stray(ball.vertices, "ball"));
  for (const Vector3d& stray : {Vector3d(1e7, 5, 5), Vector3d(5, -1e7, 0), Vector3d(0, 0, 1e6)}) {
    ball.vertices.col(7) = stray;
    CHECK_THROWS_WITH(
        require_no_stray(ball.vertices, "ball.stl"),
        Contains("ball.stl: the vertex at (") && Contains("1e+0") && Contains("which span 80 x "));
  }
  ball.vertices.col(8) = ball.vertices.col(7) * 1.1;  // two are a part of the shape
  CHECK_NOTHROW(require_no_stray(ball.vertices, "ball"));
  CHECK_NOTHROW(require_no_stray(Eigen::Matrix3Xd(3, 0), "nothing"));
}

TEST_CASE("a mesh beyond memory is refused with the edge that would do", "[mesh][limits]") {
  const SurfaceMesh ball = sphere_surface({0, 0, 0}, 0.04, 3);
  CHECK_NOTHROW(require_meshable(ball, 0.002, 0.002, "ball"));
  std::string said;
  try {
    require_meshable(ball, 1e-5, 1e-5, "ball.stl");
  } catch (const Error& error) { said = error.what(); }
  CHECK_THAT(said, Contains("ball.stl: edges of 1e-05 m make some 3.8e+11 nodes") ||
                       Contains("ball.stl: edges of 1e-05 m make some 3.5e+11 nodes") ||
                       Contains("ball.stl: edges of 1e-05 m make some 3.6e+11 nodes"));
  const std::size_t at = said.find("bearable; edges of ");
  REQUIRE(at != std::string::npos);
  const double would_do = std::stod(said.substr(at + 19));
  CHECK_NOTHROW(require_meshable(ball, would_do, would_do, "ball"));
  CHECK_THROWS_AS(require_meshable(ball, 0.9 * would_do, 0.9 * would_do, "ball"), Error);
  CHECK_THROWS_WITH(remesh_surface(ball, 1e-5, "ball.stl"), Contains("would do"));
  // Where the trouble is inside, the skin's edges are left as they are.
  try {
    require_meshable(ball, 0.002, 1e-5, "ball.stl");
  } catch (const Error& error) { said = error.what(); }
  CHECK_THAT(said, Contains("ball.stl: inner edges of 1e-05 m make some "));
  const std::size_t inner = said.find("bearable; inner edges of ");
  REQUIRE(inner != std::string::npos);
  const double inner_edge = std::stod(said.substr(inner + 25));
  CHECK_NOTHROW(require_meshable(ball, 0.002, inner_edge, "ball"));
  CHECK_THROWS_AS(require_meshable(ball, 0.002, 0.9 * inner_edge, "ball"), Error);
}

TEST_CASE("a solid that loses more than its facets explain is refused", "[mesh][limits]") {
  const SurfaceMesh ball = sphere_surface({0, 0, 0}, 0.04, 4);
  const double volume = enclosed_volume(ball);
  CHECK_NOTHROW(require_same_volume(ball, 0.991 * volume, 0.0, "ball"));
  CHECK_THROWS_WITH(require_same_volume(ball, 0.985 * volume, 0.0, "ball.stl"),
                    Contains("ball.stl: encloses 0.000267") && Contains("try a shorter edge"));
  CHECK_NOTHROW(require_same_volume(ball, 0.985 * volume, 0.008, "ball"));  // 0.5 / 25 more
  // However coarse the edge, it does not explain a tenth of the body.
  CHECK_THROWS_AS(require_same_volume(ball, 0.88 * volume, 10.0, "ball"), Error);
  CHECK_THROWS_WITH(remesh_surface(ball, 10.0, "ball.stl"), Contains("ball.stl: "));
  for (const double edge : {0.02, 0.01}) {  // realistic edges are accepted
    INFO("edge " << edge);
    CHECK_NOTHROW(remesh_surface(ball, edge, "ball"));
  }
}

TEST_CASE("shells that nearly touch are refused with the place", "[mesh][limits]") {
  const SurfaceMesh apart =
      test::joined(box_surface({0, 0, 0}, {1, 1, 1}), box_surface({1.01, 0, 0}, {2, 1, 1}));
  CHECK_NOTHROW(require_gaps(apart, "boxes"));
  const SurfaceMesh near =
      test::joined(box_surface({0, 0, 0}, {1, 1, 1}), box_surface({1 + 1e-9, 0, 0}, {2, 1, 1}));
  CHECK_THROWS_WITH(
      require_gaps(near, "boxes.stl"),
      Contains("boxes.stl: two closed shells come within 1e-09 m of each other at (1"));
}

TEST_CASE("a wrap beyond memory is refused with the size that would do", "[mesh][limits]") {
  const SurfaceMesh ball = sphere_surface({0, 0, 0}, 0.04, 3);
  CHECK_NOTHROW(require_wrappable(ball, 2e-4, "ball"));
  std::string said;
  try {
    require_wrappable(ball, 1e-6, "ball.stl");
  } catch (const Error& error) { said = error.what(); }
  CHECK_THAT(said, Contains("ball.stl: a wrap of 1e-06 m around 0.02"));
  const std::size_t at = said.find("bearable; ");
  REQUIRE(at != std::string::npos);
  const double would_do = std::stod(said.substr(at + 10));
  CHECK_NOTHROW(require_wrappable(ball, would_do, "ball"));
  CHECK_THROWS_AS(require_wrappable(ball, 0.9 * would_do, "ball"), Error);
}

}  // namespace
}  // namespace palpable
