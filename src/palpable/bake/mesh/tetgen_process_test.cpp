#include "palpable/bake/mesh/tetgen_process.h"

#include "tests/support/meshes.h"
#include "tests/support/test.h"

#include <string>
#include <variant>

namespace palpable {
namespace {

using test::flipped;
using test::joined;

TEST_CASE("TetGen fills a box and leaves its hole", "[mesh][tetgen]") {
  const SurfaceMesh hollow = joined(box_surface({0, 0, 0}, {1, 1, 1}),
                                    flipped(box_surface({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75})));
  const auto filled = run_tetgen({.surface = hollow, .largest_volume = 0.1});
  const auto with_hole = run_tetgen(
      {.surface = hollow, .largest_volume = 0.1, .holes = {Eigen::Vector3d(0.5, 0.5, 0.5)}});
  REQUIRE(std::holds_alternative<TetMesh>(filled));
  REQUIRE(std::holds_alternative<TetMesh>(with_hole));
  CHECK(std::abs(std::abs(tet_volumes(std::get<TetMesh>(filled)).sum()) - 1.0) < 1e-12);
  CHECK(std::abs(std::abs(tet_volumes(std::get<TetMesh>(with_hole)).sum()) - 0.875) < 1e-12);
}

TEST_CASE("what TetGen gives up on, or crashes on, comes back as a reason", "[mesh][tetgen]") {
  // Two boxes that cross: TetGen throws 3 and crashes when it is destroyed after that.
  const SurfaceMesh crossing =
      joined(box_surface({0, 0, 0}, {1, 1, 1}), box_surface({0.5, 0.3, 0.2}, {1.7, 0.8, 0.9}));
  const auto made = run_tetgen({.surface = crossing, .largest_volume = 0.1});
  REQUIRE(std::holds_alternative<std::string>(made));
  CHECK_THAT(std::get<std::string>(made), Catch::Contains("passes through itself") ||
                                              Catch::Contains("gave up") ||
                                              Catch::Contains("crashed"));
  // And the next one works.
  CHECK(std::holds_alternative<TetMesh>(
      run_tetgen({.surface = box_surface({0, 0, 0}, {1, 1, 1}), .largest_volume = 0.1})));
}

}  // namespace
}  // namespace palpable
