#include "palpable/bake/truth/obstacle_way.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/geometry/mesh_file.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Vector3d;

ObstacleMotion read(const std::vector<std::string>& texts, const std::filesystem::path& pose = {}) {
  return read_obstacle_way(texts, pose);
}

TEST_CASE("forms of obstacles and their ways", "[truth]") {
  const ObstacleMotion way =
      read({"sphere 8mm at 0,0,0.16 to 0,0,140mm",
            "capsule 1.2mm,0.4cm at 0,0,1 and 0,0,2 to 0,1,1", "plane 0,0,-2 at 0,0,0.5"});
  const Obstacle half = way(0.5);
  REQUIRE(half.capsules.size() == 2);
  CHECK((half.capsules[0].a - Vector3d(0, 0, 0.15)).norm() < 1e-15);
  CHECK(half.capsules[0].ra == Approx(0.008));
  CHECK((half.capsules[1].b - Vector3d(0, 0.5, 2)).norm() < 1e-15);
  CHECK(half.capsules[1].ra == Approx(0.0012));
  CHECK(half.capsules[1].rb == Approx(0.004));
  REQUIRE(half.half_spaces.size() == 1);
  CHECK((half.half_spaces[0].normal - Vector3d(0, 0, -1)).norm() < 1e-15);
  CHECK(half.half_spaces[0].point.z() == 0.5);
}

TEST_CASE("a surface goes from pose to pose", "[truth]") {
  const test::ScratchFolder folder("obstacle_way");
  const auto file = folder.path() / "box.ply", poses = folder.path() / "way.txt";
  write_ply(file, box_surface({-1, -1, -1}, {1, 1, 1}));
  write_whole_file(poses, "0 0 0 2 0 0 0 1\n1 0 0 1 0 0 0 1\n3 0 0 1 0 0 0.70710678 0.70710678\n");
  const ObstacleMotion way = read({file.string()}, poses);
  CHECK(way(0.0).surfaces[0].body_from_shape.translation().z() == 2.0);
  CHECK(way(1.0 / 6.0).surfaces[0].body_from_shape.translation().z() == Approx(1.5));
  const Rigid3 turning = way(2.0 / 3.0).surfaces[0].body_from_shape;
  CHECK(turning.translation().z() == Approx(1.0));
  CHECK((turning.linear() * Vector3d::UnitX()).x() == Approx(std::cos(std::numbers::pi / 4)));

  CHECK_THROWS_WITH(read({file.string()}), Contains("a file of poses is needed"));
  CHECK_THROWS_WITH(read({"sphere 1mm at 0,0,0"}, poses), Contains("no obstacle is a surface"));
  SurfaceMesh open = box_surface({-1, -1, -1}, {1, 1, 1});
  open.triangles.conservativeResize(3, 11);
  write_ply(file, open);
  CHECK_THROWS_WITH(read({file.string()}, poses), Contains("box.ply") && Contains("encloses"));
}

TEST_CASE("what is no obstacle is refused with what one looks like", "[truth]") {
  for (const char* text : {"sphere", "sphere 8mm", "sphere 8mm at", "sphere 8mm at 0,0",
                           "sphere -1mm at 0,0,0", "sphere nan at 0,0,0", "sphere 8mm at 0,0,0 to",
                           "sphere 8mm at 0,0,0 to 0,0,0 now", "sphere 8 furlongs at 0,0,0",
                           "capsule 1mm at 0,0,0", "plane 0,0,0 at 0,0,0", "", "none.stl"}) {
    INFO(text);
    CHECK_THROWS_WITH(read({text}), Contains("obstacle '" + std::string(text)) &&
                                        Contains("sphere 8mm at 0,0,0.16 to 0,0,0.14"));
  }
}

TEST_CASE("any words are an obstacle or are refused", "[truth]") {
  // Valid and nearly valid words, in random order.
  const std::vector<std::string> words{
      "sphere",  "capsule", "plane",   "at",   "and",     "to",        "8mm",
      "1e-3",    "0,0,1",   "0,0",     "-1mm", "1mm,2cm", ",",         "0,,1",
      "1e400",   "1e308m",  "nan,0,0", "inf",  "mm",      "0,0,0,0",   "\xff",
      "+1,-1,1", "m,m,m",   "1 , 2",   "\t",   "0x1p3",   "1e308,0,0", "-0,-0,-0"};
  std::mt19937 random(7);
  int read_well = 0;
  for (int n = 0; n < 20000; ++n) {
    std::string text;
    if (n % 4 == 0) text = "sphere 8mm at 0,0,1";  // half of the texts begin with a valid form
    if (n % 4 == 2) text = "capsule 1mm,2mm at 0,0,1 and 0,0,2";
    for (auto k = random() % 7; k > 0; --k) {
      text += ' ';
      text += words[random() % words.size()];
    }
    INFO(text);
    try {
      const Obstacle there = read({text})(1.0);
      ++read_well;
      CHECK(there.capsules.size() + there.half_spaces.size() == 1);
      for (const Capsule& capsule : there.capsules) {
        CHECK((capsule.a.allFinite() && capsule.b.allFinite()));
        CHECK((std::min(capsule.ra, capsule.rb) > 0.0 && std::isfinite(capsule.ra + capsule.rb)));
      }
    } catch (const Error& error) { CHECK(std::string(error.what()).starts_with("obstacle '")); }
  }
  CHECK(read_well > 1000);
}

}  // namespace
}  // namespace palpable
