#include "palpable/desk/clip_files/place.h"

#include "palpable/common/base/error.h"
#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cmath>
#include <fstream>

namespace palpable {
namespace {

using Eigen::Vector3d;

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

TEST_CASE("sixteen numbers are the matrix, given as text or in a file", "[clip_files]") {
  const test::ScratchFolder folder("place");
  const std::string text = "0 -1 0 0.1\n1 0 0 0.2\n0 0 1 0.7  \n0 0 0 1";
  const Rigid3 pose = read_pose(text);
  CHECK(apart(pose * Vector3d(1, 0, 0), {0.1, 1.2, 0.7}) < 1e-15);
  std::ofstream(folder.path() / "pose.txt") << "# the desk\n" << text << "\n";
  CHECK(read_pose((folder.path() / "pose.txt").string()).isApprox(pose));
  std::ofstream(folder.path() / "scene.toml")
      << "camera_from_body = [0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, 0.7, 0, 0, 0, 1]\n"
         "press_static = true\n";
  CHECK(read_pose((folder.path() / "scene.toml").string()).isApprox(pose));
  const SceneFile scene = read_scene_file(folder.path() / "scene.toml");
  REQUIRE(scene.camera_from_body.has_value());
  CHECK(scene.camera_from_body->isApprox(pose));
  CHECK(scene.press_static);
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

}  // namespace
}  // namespace palpable
