#include "palpable/desk/clip_files/camera_paths.h"

#include "palpable/common/base/error.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"
#include "tests/support/text_in.h"

#include <filesystem>
#include <string>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using test::refusal_of;
using test::says;
using test::ScratchFolder;
using test::TextIn;
using test::write_bytes;

/// A quarter turn about Z and a translation of (0.1, -0.2, 0.5) m.
Rigid3 some_pose() {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  pose.translation() = Eigen::Vector3d(0.1, -0.2, 0.5);
  return pose;
}

TEST_CASE("a pose in TUM's format is the line it always was, and comes back", "[clip_files]") {
  const std::string line = trajectory_line({1.0 / 30, some_pose()});
  CHECK(line ==
        "0.033333 0.1000000 -0.2000000 0.5000000 0.000000000 0.000000000 0.707106781 "
        "0.707106781\n");
  const TextIn file(std::string(kTrajectoryRemark) + line + "1,2, 3\t4 0 0 0 1\r\n");
  const std::vector<StampedPose> read = read_trajectory(file.path);
  REQUIRE(read.size() == 2);
  CHECK(read[0].time == 0.033333);
  CHECK(read[0].world_from_camera.isApprox(some_pose(), 1e-8));
  CHECK(read[1].world_from_camera.translation() == Eigen::Vector3d(2, 3, 4));
}

TEST_CASE("lines that are no poses are refused with file and line", "[clip_files][errors]") {
  const auto read = [](const fs::path& path) { (void)read_trajectory(path); };
  const std::string first = "0 0 0 0 0 0 0 1\n";
  CHECK(refusal_of("", read).empty());
  CHECK(says(refusal_of(first + "0.1 0 0 0 0 0 1\n", read), "file: line 2: 8 numbers are wanted"));
  CHECK(says(refusal_of(first + "0.1 0 0 0 0 0 0 1 5\n", read), "line 2: 8 numbers"));
  CHECK(says(refusal_of(first + "0.1 0 0 x 0 0 0 1\n", read), "line 2: 8 numbers"));
  CHECK(says(refusal_of(first + "0.1 0 0 nan 0 0 0 1\n", read), "line 2: 8 numbers"));
  CHECK(says(refusal_of(first + "0.1 [0 0 0] 0 0 0 1\n", read), "line 2: 8 numbers"));
  CHECK(says(refusal_of(first + "0.1;0;0;0;0;0;0;1\n", read), "line 2: 8 numbers"));
  CHECK(says(refusal_of("0 0 0 0 0 0 0 2\n", read), "line 1: the quaternion has length 2, not 1"));
  CHECK(says(refusal_of("# a\n" + first + first, read),
             "line 3: times must rise: 0 s comes after 0"));
  CHECK_THROWS_WITH(read_trajectory("nowhere.txt"), "nowhere.txt: cannot be read");
}

// Checks the second of two poses, which is the same in every format: a quarter turn about Z at
// (1, 2, 3).
void check_second(const PublishedPoses& read, double time) {
  REQUIRE(read.poses.size() == 2);
  CHECK(read.poses[1].time == Approx(time).epsilon(1e-12));
  const Rigid3& pose = read.poses[1].world_from_camera;
  CHECK((pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm() < 1e-6);
}

TEST_CASE("one pose reads the same from a file of TUM, KITTI, 7-Scenes and EuRoC",
          "[clip_files][poses]") {
  const ScratchFolder folder("published");
  write_bytes(folder / "groundtruth.txt",
              "# timestamp\n1305031098.5 0 0 0 0 0 0 1\n"
              "1305031099 1 2 3 0 0 0.70710678 0.70710678\n");
  const PublishedPoses tum = read_published_poses(folder / "groundtruth.txt");
  CHECK(tum.format == "TUM");
  check_second(tum, 1305031099);

  const std::string first_rows = "1 0 0 0 0 1 0 0 0 0 1 0";
  const std::string second_rows = "0 -1 0 1 1 0 0 2 0 0 1 3";
  write_bytes(folder / "poses.txt", first_rows + "\n" + second_rows + "\n");
  check_second(read_published_poses(folder / "poses.txt"), 0.1);
  check_second(read_published_poses(folder / "poses.txt", 20), 0.05);
  write_bytes(folder / "times.txt", "0\n0.103736\n");
  CHECK(read_published_poses(folder / "poses.txt").format == "KITTI");
  check_second(read_published_poses(folder / "poses.txt"), 0.103736);

  fs::create_directories(folder / "scene");
  write_bytes(folder / "scene/frame-000009.pose.txt", first_rows + "\n0 0 0 1\n");
  write_bytes(folder / "scene/frame-000010.pose.txt", second_rows + "\n0 0 0 1\n");
  const PublishedPoses scene = read_published_poses(folder / "scene");
  CHECK(scene.of == "depth camera");
  check_second(scene, 1.0 / 30);
  check_second(read_published_poses(folder / "scene/frame-000010.pose.txt", 15), 1.0 / 15);

  write_bytes(folder / "data.csv",
              "#timestamp, p_x, ...\n1403636579763555584,0,0,0,1,0,0,0,9,9,9\n"
              "1403636579813555456,1,2,3,0.70710678,0,0,0.70710678,9,9,9\n");
  const PublishedPoses euroc = read_published_poses(folder / "data.csv");
  CHECK(euroc.of == "body");
  check_second(euroc, 1403636579.813555456);
}

TEST_CASE("poses that cannot be read are refused with their file and line",
          "[clip_files][poses][refusal]") {
  const ScratchFolder folder("published_refusals");
  const auto refused = [&](const char* name, const std::string& text) {
    write_bytes(folder / name, text);
    try {
      (void)read_published_poses(folder / name);
    } catch (const Error& error) { return std::string(error.what()); }
    return std::string("was read");
  };
  const std::string rows = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  CHECK_THAT(refused("a.txt", ""), Contains("a.txt: holds no poses that are known"));
  CHECK_THAT(refused("a.txt", "hello"), Contains("TUM: time tx ty tz"));
  CHECK_THAT(refused("a.txt", "0 0 0 0 0 0 0 1\n"), Contains("holds 1 poses; two at least"));
  CHECK_THAT(refused("a.txt", rows + "1 2 3\n"), Contains("a.txt: line 2: 12 numbers"));
  CHECK_THAT(refused("a.txt", rows + "2 0 0 0 0 1 0 0 0 0 1 0\n"), Contains("line 2: the matrix"));
  CHECK_THAT(refused("a.csv", "x,y\n"), Contains("holds 0 poses"));
  CHECK_THAT(refused("frame-0.pose.txt", "1 0 0 0"), Contains("frame-0.pose.txt: 16 numbers"));
  write_bytes(folder / "times.txt", "0\n");
  CHECK_THAT(refused("a.txt", rows + rows), Contains("1 times for the 2 poses"));
  write_bytes(folder / "times.txt", "0\nx\n");
  CHECK_THAT(refused("a.txt", rows + rows), Contains("line 2: is no time"));
  write_bytes(folder / "times.txt", "1\n1\n");
  CHECK_THAT(refused("a.txt", rows + rows), Contains("times must rise"));
  CHECK_THROWS_WITH(read_published_poses(folder / "none.txt"), Contains("is not there"));
}

}  // namespace
}  // namespace palpable
