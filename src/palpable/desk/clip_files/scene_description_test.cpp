#include "palpable/desk/clip_files/scene_description.h"

#include "palpable/common/base/error.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::ScratchFolder;
using test::tolerance;

std::vector<DescribedBody> read(const std::string& text) {
  const ScratchFolder folder("scene_description");
  test::write_bytes(folder / "desk.toml", text);
  return read_scene_description(folder / "desk.toml");
}

std::string refusal(const std::string& text) {
  try {
    (void)read(text);
  } catch (const Error& error) { return error.what(); }
  return "";
}

constexpr const char* kTwo = R"([[body]]
name = "lower"
file = "beam.palpable"
description = "../bodies/beam.toml"
method = "intrusive-pgd"
at = ["0 mm", "0 mm", "40 mm"]

[[body]]
name = "upper"
file = "beam.palpable"
beside = "lower"
at = ["10 mm", "0 mm", "0.07 m"]
turn = 90
scale = 0.5
set = ["stiffness=0.8"]
color = [200, 120, 80]
)";

TEST_CASE("a scene says which bodies stand where", "[clip_files][scene]") {
  const std::vector<DescribedBody> bodies = read(kTwo);
  REQUIRE(bodies.size() == 2);
  CHECK(bodies[0].name == "lower");
  CHECK(bodies[0].file.filename() == "beam.palpable");
  CHECK(bodies[0].file.is_absolute());  // relative to the scene's folder, which is absolute
  CHECK_FALSE(bodies[0].place.anchor);
  CHECK(bodies[1].place.beside == 0);
  CHECK(bodies[1].scale == 0.5);
  CHECK(bodies[1].set == std::vector<std::string>{"stiffness=0.8"});
  CHECK(bodies[1].color == Rgb{200, 120, 80});
  const std::vector<Rigid3> poses = scene_from_bodies(bodies);
  CHECK((poses[1].translation() - Vector3d(0.01, 0, 0.11)).norm() < tolerance(1e-12, "rounding"));
  CHECK((poses[1].linear() * Vector3d::UnitX() - Vector3d::UnitY()).norm() <
        tolerance(1e-12, "rounding"));
  CHECK_THROWS_WITH(expect_baked(bodies[0], "desk.toml"),
                    Catch::Contains("of desk.toml") &&
                        Catch::Contains("bodies/beam.toml --method intrusive-pgd"));
}

TEST_CASE("errors in a scene are reported with their line number", "[clip_files][errors]") {
  const std::string one = "[[body]]\nname = \"a\"\nfile = \"a.palpable\"\n";
  CHECK_THAT(refusal(""), Catch::Contains("has no [[body]]"));
  CHECK_THAT(refusal(one + "colour = [1, 2, 3]\n"),
             Catch::Contains("desk.toml:4: unknown key 'colour'") && Catch::Contains("'color'"));
  CHECK_THAT(refusal(one + one),
             Catch::Contains("desk.toml:5: 'name'") && Catch::Contains("is another body's, too"));
  CHECK_THAT(refusal("[[body]]\nname = \"a/b\"\n"), Catch::Contains("letters, digits"));
  CHECK_THAT(refusal("[[body]]\nname = \"a\"\n"), Catch::Contains("'file'"));
  CHECK_THAT(refusal(one + "beside = \"b\"\n"), Catch::Contains("no body above it"));
  CHECK_THAT(refusal(one + "anchor = \"board\"\nbeside = \"a\"\n"),
             Catch::Contains("exclude each other"));
  CHECK_THAT(refusal(one + "anchor = \"plain\"\n"), Catch::Contains("did you mean 'plane'"));
  CHECK_THAT(refusal(one + "place = [0, 0, 1, 0, 0, 0]\n"),
             Catch::Contains("goes with anchor = \"place\""));
  CHECK_THAT(refusal(one + "anchor = \"place\"\nplace = [0, 0, -1, 0, 0, 0]\n"),
             Catch::Contains("behind the camera"));
  CHECK_THAT(refusal(one + "at = [1, 2, 3]\n"), Catch::Contains("unit"));
  CHECK_THAT(refusal(one + "color = [1, 2]\n"), Catch::Contains("red, green, blue"));
  CHECK_THAT(refusal(one + "scale = 0\n"), Catch::Contains("'scale'"));
  const std::vector<DescribedBody> seen = read(one + "anchor = \"plane\"\n");
  CHECK_THROWS_WITH(scene_from_bodies(seen), Catch::Contains("which only images show"));
}

}  // namespace
}  // namespace palpable
