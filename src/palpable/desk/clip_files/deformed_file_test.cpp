#include "palpable/desk/clip_files/deformed_file.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using Catch::Matchers::Contains;

TEST_CASE("lines of deformed.jsonl are read as they were written, the last of a frame counts",
          "[clip_files]") {
  const test::ScratchFolder folder("deformed_lines");
  CHECK(read_deformed_lines(folder.path()).empty());
  DeformedLine touch{.frame = 7, .depth = 0.0041, .force = {0.5, -1.25, 3}, .point = {{1, 2, 3}}};
  DeformedLine doubtful{.frame = 3, .scored = false, .why = "depends on the \"way\""};
  DeformedLine earlier = touch;
  earlier.depth = 1;
  write_whole_file(folder.path() / "deformed.jsonl",
                   deformed_line(earlier) + deformed_line(touch) + deformed_line(doubtful));
  const std::vector<DeformedLine> lines = read_deformed_lines(folder.path());
  REQUIRE(lines.size() == 2);
  CHECK(lines[0].frame == 3);
  CHECK_FALSE(lines[0].scored);
  CHECK(lines[0].why == doubtful.why);
  CHECK_FALSE(lines[0].point);
  CHECK(lines[1].depth == touch.depth);
  CHECK(lines[1].force == touch.force);
  CHECK(*lines[1].point == *touch.point);

  write_whole_file(folder.path() / "deformed.jsonl", deformed_line(touch) + "{\"frame\":8}\n");
  CHECK_THROWS_WITH(read_deformed_lines(folder.path()), Contains("deformed.jsonl: line 2"));
}

TEST_CASE("a PLY with values keeps every vertex and its number", "[clip_files]") {
  const test::ScratchFolder folder("valued_ply");
  ValuedSurface written;
  // Two vertices at the same position, and one vertex that no triangle uses.
  written.surface.vertices =
      (Eigen::Matrix3Xd(3, 5) << 0, 1, 0, 0, 5, 0, 0, 1, 0, 5, 0, 0, 0, 0, 5).finished();
  written.surface.triangles = (Eigen::Matrix3Xi(3, 1) << 0, 1, 2).finished();
  written.values = Eigen::VectorXd::LinSpaced(5, 0.5, 2.5);
  const auto file = folder.path() / "skin.ply";
  write_valued_ply(file, written, kVonMisesProperty);
  const ValuedSurface read = value_or_throw(read_valued_ply(file, kVonMisesProperty));
  CHECK(read.surface.vertices == written.surface.vertices);
  CHECK(read.surface.triangles == written.surface.triangles);
  CHECK(read.values == written.values);
  CHECK(value_or_throw(read_valued_ply(file, "other")).values.size() == 0);

  write_whole_file(file,
                   "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                   "property float z\nproperty float von_mises\nelement face 1\n"
                   "property list uchar int vertex_indices\nend_header\n0 0 0 1\n1 0 0 nan\n"
                   "0 1 0 2\n3 0 1 2\n");
  CHECK_THROWS_WITH(value_or_throw(read_valued_ply(file, kVonMisesProperty)),
                    Contains("skin.ply") && Contains("von_mises is not finite"));
}

}  // namespace
}  // namespace palpable
