#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/scorecard/figures.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <string>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using test::ScratchFolder;
using test::tolerance;
using test::write_bytes;

constexpr double kBegin = 1305031098.6659;  // s, an arbitrary clock

// A camera that moves 2 m along an arc in 2 s while it rotates. @param t  s
Rigid3 pose_at(double t) {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = Eigen::AngleAxisd(0.3 * t, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(t, 0.1 * std::sin(3 * t), 0.05 * t * t);
  return pose;
}

PublishedPoses published(const std::string& of = "left camera") {
  PublishedPoses poses{"TUM", of, {}};
  for (int k = 0; k <= 200; ++k) poses.poses.push_back({kBegin + 0.01 * k, pose_at(0.01 * k)});
  return poses;
}

// Every third of the published poses, in another world frame and with `offset` applied to the
// camera.
std::string found(const Rigid3& offset = Rigid3::Identity(), double begin = kBegin) {
  Rigid3 world = Rigid3::Identity();
  world.linear() = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  world.translation() = Eigen::Vector3d(5, 6, 7);
  std::string lines;
  for (int k = 0; k <= 200; k += 3) {
    lines += trajectory_line({begin + 0.01 * k, world * pose_at(0.01 * k) * offset});
  }
  return lines;
}

TEST_CASE("the published path itself, in another world and at another rate, has no error",
          "[scorecard][poses]") {
  const ScratchFolder folder("pose_scores");
  write_bytes(folder / "trajectory.txt", found());
  for (const fs::path& result : {folder.path(), folder / "trajectory.txt"}) {
    const PoseScores scores = score_poses(published(), result);
    CHECK(scores.matched == 67);
    CHECK(scores.found == 67);
    CHECK(scores.published == 201);
    CHECK(scores.seconds == Approx(1.98).margin(1e-5));
    CHECK(scores.path_m == Approx(2.03).margin(0.03));
    CHECK(scores.ate_mm <= tolerance(1e-3, "files have a tenth of a micrometre"));
    CHECK(scores.rpe_mm.value() <= tolerance(1e-3, "the same"));
    CHECK(scores.end_error_percent.value() <= tolerance(1e-3, "the same"));
  }
}

TEST_CASE("an error at the end of a tenth of the path is 10 %", "[scorecard][poses]") {
  const ScratchFolder folder("pose_end");
  PublishedPoses straight{"KITTI", "left camera", {}};
  std::string lines;
  for (int k = 0; k <= 10; ++k) {
    Rigid3 pose = Rigid3::Identity();
    pose.translation().z() = 0.1 * k;
    straight.poses.push_back({0.1 * k, pose});
    pose.translation().z() *= 1.1;
    lines += trajectory_line({0.1 * k, pose});
  }
  write_bytes(folder / "a.txt", lines);
  const PoseScores scores = score_poses(straight, folder / "a.txt");
  CHECK(scores.end_error_percent.value() == Approx(10).epsilon(1e-6));
  // The errors of the 11 positions are 10 mm apart: their rms about the mean is sqrt(10) * 10 mm.
  CHECK(scores.ate_mm == Approx(10 * std::sqrt(10.0)).epsilon(1e-4));
  const Json json = json_of(scores);
  CHECK(json["poses_matched"].get<int>() == 11);
  CHECK(json["end_error_percent"].get<double>() == *scores.end_error_percent);
  const std::string text = text_of(scores);
  CHECK_THAT(text,
             Catch::StartsWith("compared: 11 of 11 found poses with 11 published ones (KITTI, "
                               "of the left camera) over 1.00 s\naccuracy: position off by "));
  CHECK_THAT(text, Contains(", end of the path by 10.00 % of its length\nspeed:    not stated"));
}

TEST_CASE("a colour camera's path is converted if the depth camera's poses are published",
          "[scorecard][poses]") {
  const ScratchFolder folder("pose_sensors");
  Rigid3 color_from_depth = Rigid3::Identity();
  color_from_depth.linear() = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  color_from_depth.translation().x() = -0.5;
  write_bytes(folder / "trajectory.txt", found(color_from_depth.inverse()));
  CHECK(score_poses(published("depth camera"), folder.path()).ate_mm > 10);
  std::string rows;
  for (int k = 0; k < 16; ++k) {
    rows += (k == 0 ? "" : ", ") + fmt::format("{}", color_from_depth.matrix()(k / 4, k % 4));
  }
  write_bytes(folder / "live.json", "{\"color_from_depth\": [" + rows + "]}");
  CHECK(score_poses(published("depth camera"), folder.path()).ate_mm <
        tolerance(1e-3, "files have a tenth of a micrometre"));
  CHECK(score_poses(published("left camera"), folder.path()).ate_mm > 10);
}

TEST_CASE("paths without a common time are refused with the times of both",
          "[scorecard][poses][refusal]") {
  const ScratchFolder folder("pose_refusals");
  write_bytes(folder / "trajectory.txt", found(Rigid3::Identity(), 0));
  CHECK_THROWS_WITH(score_poses(published(), folder.path()),
                    Contains("published are 1305031098.666 to 1305031100.666 s, found 0.000 to"));
  write_bytes(folder / "trajectory.txt", "");
  CHECK_THROWS_WITH(score_poses(published(), folder.path()), Contains("found no pose"));
  CHECK_THROWS_WITH(score_poses(published(), folder / "none"), Contains("no such file"));
}

}  // namespace
}  // namespace palpable
