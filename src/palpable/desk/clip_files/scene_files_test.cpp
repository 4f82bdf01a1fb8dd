#include "palpable/desk/clip_files/scene_files.h"

#include "palpable/common/base/error.h"
#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"
#include "tests/support/text_in.h"

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;
namespace fs = std::filesystem;
using test::refusal_of;
using test::says;
using test::ScratchFolder;
using test::TextIn;

double apart(const Vector3d& a, const Vector3d& b) { return (a - b).norm(); }

TEST_CASE("six numbers with no angles stand the body upright before a level camera",
          "[clip_files]") {
  const Rigid3 pose = read_pose("0.1 0.2 0.5 0 0 0");
  CHECK(apart(pose * Vector3d(0, 0, 0), {0.1, 0.2, 0.5}) < 1e-15);
  CHECK(apart(pose * Vector3d(0, 0, 0.1), {0.1, 0.1, 0.5}) < 1e-15);  // up is -Y of the camera
  CHECK(apart(pose * Vector3d(0.1, 0, 0), {0.2, 0.2, 0.5}) < 1e-15);
  CHECK(apart(pose * Vector3d(0, 0.1, 0), {0.1, 0.2, 0.6}) < 1e-15);
}

TEST_CASE("pitch is the downward tilt of the camera, yaw turns the body about its upright axis",
          "[clip_files]") {
  // For a camera that looks straight down, the body's top is nearer than its base.
  CHECK(apart(read_pose("0 0 1 0 90 0") * Vector3d(0, 0, 0.1), {0, 0, 0.9}) < 1e-15);
  CHECK(apart(read_pose("0 0 1 0 0 90") * Vector3d(0.1, 0, 0), {0, 0, 1.1}) < 1e-15);
  CHECK(apart(read_pose("0 0 1 0 0 90") * Vector3d(0, 0, 0.1), {0, -0.1, 1}) < 1e-15);
  CHECK(apart(read_pose("0 0 1 90 0 0") * Vector3d(0, 0, 0.1), {0.1, 0, 1}) < 1e-15);
}

TEST_CASE("three different angles are applied in the order yaw, pitch, roll", "[clip_files]") {
  // By hand: yaw about the body's upright axis, then upright before a level camera, then the
  // camera's downward tilt about X, then its roll about Z (clockwise in the picture: Y is down).
  const double degree = std::numbers::pi / 180;
  const double cy = std::cos(20 * degree), sy = std::sin(20 * degree);
  const double cp = std::cos(35 * degree), sp = std::sin(35 * degree);
  const double cr = std::cos(10 * degree), sr = std::sin(10 * degree);
  const Vector3d X(0.3, -0.2, 0.5);
  const Vector3d turned(cy * X.x() - sy * X.y(), sy * X.x() + cy * X.y(), X.z());
  const Vector3d upright(turned.x(), -turned.z(), turned.y());
  const Vector3d tilted(upright.x(), cp * upright.y() - sp * upright.z(),
                        sp * upright.y() + cp * upright.z());
  const Vector3d rolled(cr * tilted.x() - sr * tilted.y(), sr * tilted.x() + cr * tilted.y(),
                        tilted.z());
  CHECK(apart(read_pose("0.1 0.2 0.7 10 35 20") * X, rolled + Vector3d(0.1, 0.2, 0.7)) < 1e-15);
}

TEST_CASE("sixteen numbers are the matrix, given as text or in a file", "[clip_files]") {
  const test::ScratchFolder folder("place");
  const std::string text = "0 -1 0 0.1\n1 0 0 0.2\n0 0 1 0.7  \n0 0 0 1";
  const Rigid3 pose = read_pose(text);
  CHECK(apart(pose * Vector3d(1, 0, 0), {0.1, 1.2, 0.7}) < 1e-15);
  std::ofstream(folder.path() / "pose.txt") << "# the desk\n" << text << "\n";
  CHECK(read_pose((folder.path() / "pose.txt").string()).isApprox(pose));
  std::ofstream(folder.path() / "scene.toml")
      << "camera_from_body = [0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, 0.7, 0, 0, 0, 1]\n"
         "press_static = true\nfriction = 0.3\n";
  CHECK(read_pose((folder.path() / "scene.toml").string()).isApprox(pose));
  const SceneFile scene = read_scene_file(folder.path() / "scene.toml");
  REQUIRE(scene.camera_from_body.has_value());
  CHECK(scene.camera_from_body->isApprox(pose));
  CHECK(scene.press_static);
  CHECK(scene.friction == 0.3);
  CHECK_FALSE(read_scene_file(folder.path() / "none.toml").camera_from_body.has_value());
}

TEST_CASE("invalid poses are refused", "[clip_files][errors]") {
  CHECK_THROWS_AS(read_pose("1 2 3"), Error);
  CHECK_THROWS_AS(read_pose("0 0 -1 0 0 0"), Error);  // behind the camera
  CHECK_THROWS_AS(read_pose("0 0 nan 0 0 0"), Error);
  CHECK_THROWS_AS(read_pose("1e300 0 0.5 0 0 0"), Error);  // too far away
  CHECK_THROWS_AS(read_pose("no/such/file"), Error);
  CHECK_THROWS_AS(read_pose("1 0 0 0  0 1 0 0  0 0 -1 1  0 0 0 1"), Error);  // a mirror
  CHECK_THROWS_AS(read_pose("2 0 0 0  0 2 0 0  0 0 2 1  0 0 0 1"), Error);   // a scale
  const test::ScratchFolder folder("place");
  std::ofstream(folder.path() / "bad.toml") << "camera_from_body = [1, \n";
  CHECK_THROWS_AS(read_scene_file(folder.path() / "bad.toml"), Error);
  std::ofstream(folder.path() / "deep.toml") << "a" << test::repeated(".a", 60'000) << " = 1\n";
  CHECK_THROWS_WITH(
      read_scene_file(folder.path() / "deep.toml"),
      Catch::EndsWith("deep.toml: line 1: nested more than 64 deep, which is not read"));
  std::ofstream(folder.path() / "nan.txt") << "0 0 0.5 # m\n0 0 nan\n";
  CHECK_THROWS_WITH(read_pose((folder.path() / "nan.txt").string()),
                    Catch::EndsWith("nan.txt: holds what is no finite number"));
  std::ofstream(folder.path() / "far.toml") << "press_static = 1000\n";
  CHECK_THROWS_AS(read_scene_file(folder.path() / "far.toml"), Error);
}

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
friction = 0.6
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
  CHECK_FALSE(bodies[0].friction);
  CHECK(bodies[1].friction == 0.6);
  const std::vector<Rigid3> poses = scene_from_bodies(bodies);
  CHECK((poses[1].translation() - Vector3d(0.01, 0, 0.11)).norm() < tolerance(1e-12, "rounding"));
  CHECK((poses[1].linear() * Vector3d::UnitX() - Vector3d::UnitY()).norm() <
        tolerance(1e-12, "rounding"));
  CHECK_THROWS_WITH(
      expect_baked(bodies[0], "desk.toml"),
      Catch::Contains("of desk.toml") && Catch::Contains("bodies/beam.toml --intrusive -o "));
}

TEST_CASE("a scene file may hold options of the run, which its reader passes on",
          "[clip_files][scene]") {
  const ScratchFolder folder("scene_options");
  test::write_bytes(folder / "desk.toml", std::string("source = \"cam\"\nscale = 2\nforces = true\n"
                                                      "view = [\"camera\", \"map\"]\n\n") +
                                              kTwo);
  CHECK(read_scene_description(folder / "desk.toml").size() == 2);
  const std::vector<SceneOption> options = read_scene_options(folder / "desk.toml");
  REQUIRE(options.size() == 4);
  CHECK(options[0].name == "source");
  CHECK(options[0].words == std::vector<std::string>{"cam"});
  CHECK(options[1].words == std::vector<std::string>{"2"});
  CHECK(options[2].words == std::vector<std::string>{"true"});
  CHECK(options[3].words == std::vector<std::string>{"camera", "map"});
  CHECK(options[3].line == 4);
  test::write_bytes(folder / "date.toml", std::string("source = 1979-05-27\n") + kTwo);
  CHECK_THROWS_WITH(read_scene_options(folder / "date.toml"),
                    Catch::Contains("date.toml:1: 'source' must be a text"));
}

TEST_CASE("bodies are written as the scene that they were read from", "[clip_files][scene]") {
  const std::vector<DescribedBody> bodies = read(kTwo);
  const std::string text = scene_text(bodies);
  CHECK(scene_text(read(text)) == text);
  const std::vector<DescribedBody> again = read(text);
  REQUIRE(again.size() == 2);
  CHECK(again[0].method == "intrusive-pgd");
  CHECK(again[1].file == bodies[1].file);
  CHECK(again[1].set == bodies[1].set);
  CHECK(again[1].color == bodies[1].color);
  CHECK(again[1].scale == 0.5);
  CHECK(again[1].place.beside == 0);
  CHECK(again[1].place.anchor_from_body.isApprox(bodies[1].place.anchor_from_body,
                                                 tolerance(1e-12, "rounding of the angle")));
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
             Catch::Contains("needs anchor = \"place\" beside it"));
  CHECK_THAT(refusal(one + "anchor = \"place\"\nplace = [0, 0, -1, 0, 0, 0]\n"),
             Catch::Contains("behind the camera"));
  CHECK_THAT(refusal(one + "at = [1, 2, 3]\n"), Catch::Contains("unit"));
  CHECK_THAT(refusal(one + "color = [1, 2]\n"), Catch::Contains("red, green, blue"));
  CHECK_THAT(refusal(one + "scale = 0\n"), Catch::Contains("'scale'"));
  const std::vector<DescribedBody> seen = read(one + "anchor = \"plane\"\n");
  CHECK_THROWS_WITH(scene_from_bodies(seen), Catch::Contains("which only images show"));
}

TEST_CASE("a truth's camera is the file it always was, and comes back", "[clip_files]") {
  const ScratchFolder folder("clip_files");
  const fs::path path = folder / "camera.toml";
  TruthCamera camera;
  camera.frames_per_second = 30.0;
  camera.depth_unit = 0.00025;
  camera.camera = PinholeCamera{640, 360, 350.123456789012, 350.5, 319.25, 179.75};
  camera.baseline = 0.0630187;
  camera.sequence = "press";
  camera.seed = 5;
  camera.body = "bunny.palpable";
  write_truth_camera(path, camera);
  CHECK(test::file_bytes(path) ==
        "# The rectified left camera at half size: px; baseline in m.\n"
        "width = 640\nheight = 360\nfx = 350.123456789\nfy = 350.5\ncx = 319.25\ncy = 179.75\n"
        "baseline_m = 0.0630187\nfps = 30\ndepth_unit_m = 0.00025\nsequence = \"press\"\n"
        "seed = 5\nbody = '''bunny.palpable'''\n");
  const TruthCamera read = read_truth_camera(path);
  CHECK(read.frames_per_second == 30);
  CHECK(read.depth_unit == 0.00025);
  REQUIRE(read.camera.has_value());
  CHECK(read.camera->width == 640);
  CHECK(read.camera->height == 360);
  CHECK(read.camera->fx_px == 350.123456789);
  CHECK(read.camera->fy_px == 350.5);
  CHECK(read.camera->cx_px == 319.25);
  CHECK(read.camera->cy_px == 179.75);
  CHECK(read.baseline == 0.0630187);
  CHECK(read.sequence == "press");
  CHECK(read.seed == 5U);
  CHECK(read.body == "bunny.palpable");
  const auto again = [](const fs::path& file) { (void)read_truth_camera(file); };
  CHECK(refusal_of("fps = 30\ndepth_unit_m = 0.001\n", again).empty());
  CHECK(says(refusal_of("fps = 30\n", again), "file: has no depth_unit_m"));
  CHECK(says(refusal_of("fps = 30\ndepth_unit_m = -1\n", again),
             "file: line 2: depth_unit_m must be a number above 0"));
  CHECK(says(refusal_of("fps = = 3\n", again), "file: line 1: "));
}

TEST_CASE("a truth's camera that would overload a parser is refused with file and line",
          "[clip_files][errors]") {
  const std::string deep(1'000'000, '[');
  const auto truth = [](const fs::path& file) { (void)read_truth_camera(file); };
  CHECK(says(refusal_of("fps = 30\nbody" + test::repeated(".a", 60'000) + " = 1\n", truth),
             "file: line 2: nested more than 64 deep"));
  CHECK(says(refusal_of("fps = " + deep, truth), "file: line 1: nested more than 64 deep"));
}

TEST_CASE("a truth's camera with names that are not UTF-8 or hold quotes can be read back",
          "[clip_files][errors]") {
  const ScratchFolder folder("clip_files");
  TruthCamera camera;
  camera.frames_per_second = 30.0;
  camera.depth_unit = 0.001;
  camera.camera = PinholeCamera{64, 36, 50, 50, 32, 18};
  camera.baseline = 0.06;
  camera.seed = 1;
  for (const std::string name : {"a'''b\"c\\d.palpable", "'", "caf\xc3\xa9", "a\nb\x01"}) {
    INFO(name);
    camera.body = name;
    camera.sequence = name;
    write_truth_camera(folder / "camera.toml", camera);
    CHECK(read_truth_camera(folder / "camera.toml").body == name);
    CHECK(read_truth_camera(folder / "camera.toml").sequence == name);
  }
  camera.body = "caf\xe9";
  write_truth_camera(folder / "camera.toml", camera);
  CHECK(read_truth_camera(folder / "camera.toml").body == "caf\xef\xbf\xbd");
}

}  // namespace
}  // namespace palpable
