#include "palpable/desk/clip_files/camera_paths.h"

#include "palpable/common/base/error.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"
#include "tests/support/text_in.h"

#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <vector>

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
  CHECK(says(refusal_of(first + "1311870427,644555 0,1 0,2 0,3 0 0 0 1\n", read),
             "line 2: has decimal commas"));
  CHECK(says(refusal_of("0 0 0 0 0 0 0 2\n", read), "line 1: the quaternion has length 2, not 1"));
  CHECK(says(refusal_of("# a\n" + first + first, read),
             "line 3: times must rise: 0 s comes after 0"));
  CHECK_THROWS_WITH(read_trajectory("nowhere.txt"), "nowhere.txt: no such file");
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

TEST_CASE("the paths of phones are read from the files of their apps", "[clip_files][poses]") {
  const ScratchFolder folder("published_phones");
  for (const char* name :
       {"stray/rgb.mp4", "stray/depth/000000.png", "stray/depth/000001.png", "r3d/rgb/0.jpg",
        "r3d/rgb/1.jpg", "r3d/depth/0.exr", "r3d/depth/1.exr"}) {
    write_bytes(folder / name, "not decoded here");
  }
  write_bytes(folder / "stray/camera_matrix.csv", "48,0,31\n0,48,23\n0,0,1\n");
  write_bytes(folder / "stray/odometry.csv",
              "timestamp, frame, x, y, z, qx, qy, qz, qw\n100.5, 000000, 1, 2, 3, 0, 0, 0, 1\n"
              "100.6, 000001, 4, 5, 6, 0, 0, 0, 1\n");
  write_bytes(folder / "r3d/metadata.json",
              R"({"w":60,"h":45,"K":[48,0,0,0,48,0,29,22,1],"frameTimestamps":[100.5,100.6],)"
              R"("poses":[[0,0,0,1,1,2,3],[0,0,0,1,4,5,6]]})");
  for (const char* name : {"stray/odometry.csv", "stray", "r3d/metadata.json", "r3d"}) {
    INFO(name);
    const PublishedPoses read = read_published_poses(folder / name);
    REQUIRE(read.poses.size() == 2);
    CHECK(read.poses[0].time == Approx(100.5));
    CHECK(read.poses[1].time == Approx(100.6));
    CHECK(read.poses[1].world_from_camera.translation() == Eigen::Vector3d(4, 5, 6));
  }
}

TEST_CASE("poses are read behind a byte-order mark and between any ends of lines",
          "[clip_files][poses]") {
  const ScratchFolder folder("published_encodings");
  const std::string tum = "0.5 1 2 3 0 0 0 1\n0.6 4 5 6 0 0 0 1\n";
  const std::string kitti = "1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 4 0 1 0 5 0 0 1 6\n";
  for (const std::string& text : {tum, kitti}) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
      std::string written = "\xef\xbb\xbf";
      for (const char c : text) written += c == '\n' ? end : std::string(1, c);
      write_bytes(folder / "poses.txt", written);
      const PublishedPoses read = read_published_poses(folder / "poses.txt");
      REQUIRE(read.poses.size() == 2);
      CHECK(read.poses[0].world_from_camera.translation() == Eigen::Vector3d(1, 2, 3));
      CHECK(read.poses[1].world_from_camera.translation() == Eigen::Vector3d(4, 5, 6));
    }
  }
  write_bytes(folder / "poses.txt", std::string("\xff\xfe") + std::string("0\0 \0", 4));
  CHECK_THROWS_WITH(read_published_poses(folder / "poses.txt"), Contains("UTF-16"));
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
  CHECK_THAT(refused("a.txt", "1311870427,644555 0,1 0,2 0,3 0,0 0,0 0,0 1,0\n"),
             Contains("a.txt: its first line has decimal commas"));
  CHECK_THAT(refused("a.txt", "1311870427,644555 0,1 0,2 0,3 0 0 0 1\n"),
             Contains("a.txt: its first line has decimal commas"));
  CHECK_THAT(refused("a.txt", "1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0\n"),
             Contains("holds 1 poses; two at least"));  // commas between whole numbers
  CHECK_THAT(refused("a.txt", rows + "1 2 3\n"), Contains("a.txt: line 2: 12 numbers"));
  CHECK_THAT(refused("a.txt", rows + "2 0 0 0 0 1 0 0 0 0 1 0\n"), Contains("line 2: the matrix"));
  CHECK_THAT(refused("a.txt", rows + "1 0 0 0,5 0 1 0 0 0 0 1 0\n"), Contains("decimal commas"));
  CHECK_THAT(refused("frame-0.pose.txt", "1 0 0 0,5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"),
             Contains("frame-0.pose.txt: '1 0 0 0,5' has decimal commas"));
  fs::remove(folder / "frame-0.pose.txt");
  CHECK_THAT(refused("a.csv", "1403636579763555584;0,5;0,25;0;1;0;0;0\n"),
             Contains("decimal commas"));
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

// Poses at these times in TUM's format; the camera moves along three axes at once.
std::string path_at(const std::vector<std::string>& times) {
  std::string text;
  for (std::size_t k = 0; k < times.size(); ++k) {
    text += fmt::format("{0} {1} {1} {1} 0 0 0 1\n", times[k], 0.1 * static_cast<double>(k));
  }
  return text;
}

// Times from `begin` on with this step, as whole numbers.
std::vector<std::string> whole_times(long long begin, long long step, int count) {
  std::vector<std::string> times;
  for (int k = 0; k < count; ++k) times.push_back(std::to_string(begin + k * step));
  return times;
}

TEST_CASE("a path in nanoseconds, microseconds or milliseconds is refused with its unit",
          "[clip_files][poses][refusal]") {
  const ScratchFolder folder("path_units");
  const auto refused = [&](const std::vector<std::string>& times, bool published) {
    write_bytes(folder / "path.txt", path_at(times));
    try {
      if (published) {
        (void)read_published_poses(folder / "path.txt");
      } else {
        (void)read_trajectory(folder / "path.txt");
      }
    } catch (const Error& error) { return std::string(error.what()); }
    return std::string();
  };
  for (const bool published : {false, true}) {
    INFO(published);
    CHECK_THAT(refused(whole_times(0, 100'000'000, 100), published),
               Contains("path.txt: the times are 0 to 9900000000") && Contains("nanoseconds") &&
                   Contains("divide them by 1e9"));
    CHECK_THAT(refused(whole_times(1'403'636'579'763'555'584, 50'000'000, 9), published),
               Contains("nanoseconds"));
    CHECK_THAT(refused(whole_times(0, 33'333, 30), published), Contains("microseconds"));
    CHECK_THAT(refused(whole_times(1'700'000'000'123, 33, 30), published),
               Contains("milliseconds"));
    // Seconds of all kinds.
    CHECK(refused({"0", "0.033", "0.067"}, published).empty());
    CHECK(refused({"1403636579.76", "1403636579.81", "1403636579.86"}, published).empty());
    CHECK(refused(whole_times(0, 1, 30), published).empty());
    CHECK(refused({"0", "600", "600.5", "601"}, published).empty());
  }
  // A camera's path with whole times of 33 from one to the next; an obstacle may move that slowly.
  CHECK_THAT(refused(whole_times(0, 33, 30), true), Contains("milliseconds"));
  CHECK(refused(whole_times(0, 33, 30), false).empty());
  CHECK(refused(whole_times(0, 30, 4), true).empty());
}

TEST_CASE("a path in millimetres is refused, a car's is not", "[clip_files][errors]") {
  const test::ScratchFolder folder("paths_in_mm");
  const fs::path file = folder / "path.txt";
  const auto write_path = [&](double metres_a_second) {
    std::string text;
    for (int k = 0; k < 20; ++k) {
      text += fmt::format("{} {} 0 0 0 0 0 1\n", 0.1 * k, 0.1 * k * metres_a_second);
    }
    test::write_bytes(file, text);
  };
  write_path(300);
  CHECK_THROWS_WITH(read_trajectory(file), Catch::Contains("path.txt") &&
                                               Catch::Contains("300 m") &&
                                               Catch::Contains("in metres"));
  CHECK_THROWS_WITH(read_published_poses(file), Catch::Contains("in metres"));
  write_path(35);
  CHECK(read_trajectory(file).size() == 20);
  CHECK(read_published_poses(file).poses.size() == 20);
}

// A rotation about an axis of three different components and a position of three.
TEST_CASE("the order of a quaternion and of a position is the same on the way out and back",
          "[clip_files][poses]") {
  Rigid3 pose = Rigid3::Identity();
  const Eigen::Quaterniond q = Eigen::Quaterniond(0.8, 0.1, -0.3, 0.5).normalized();
  pose.linear() = q.toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0.1, -0.2, 0.5);
  const TextIn file(trajectory_line({1, pose}));
  CHECK(read_trajectory(file.path).at(0).world_from_camera.isApprox(pose, 1e-6));
  // EuRoC has w first, TUM has it last: by hand, so that no two mistakes cancel.
  const ScratchFolder folder("quaternion_orders");
  const std::string xyz = fmt::format("{},{},{}", q.x(), q.y(), q.z());
  write_bytes(folder / "tum.txt", fmt::format("0 0 0 0 0 0 0 1\n1 0.1 -0.2 0.5 {} {} {} {}\n",
                                              q.x(), q.y(), q.z(), q.w()));
  write_bytes(folder / "data.csv",
              fmt::format("0,0,0,0,1,0,0,0\n1000000000,0.1,-0.2,0.5,{},{}\n", q.w(), xyz));
  for (const char* name : {"tum.txt", "data.csv"}) {
    INFO(name);
    const Rigid3 read = read_published_poses(folder / name).poses.at(1).world_from_camera;
    CHECK(read.isApprox(pose, 1e-6));
    // (1, 0, 0) by the formula of the rotation matrix of (w, x, y, z).
    const double x = q.x(), y = q.y(), z = q.z(), w = q.w();
    const Eigen::Vector3d first(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y));
    CHECK((read.linear() * Eigen::Vector3d::UnitX() - first).norm() < 1e-6);
  }
}

}  // namespace
}  // namespace palpable
