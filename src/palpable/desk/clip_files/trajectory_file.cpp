#include "palpable/desk/clip_files/trajectory_file.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/desk/clip_files/text_file.h"

#include <fmt/core.h>

#include <cmath>
#include <optional>

namespace palpable {
namespace {

StampedPose stamped_pose_of(const std::string& line) {
  const std::optional<std::vector<double>> n = to_numbers(line);
  // to_numbers() also accepts brackets and semicolons, which this format does not have.
  if (!n || n->size() != 8 || line.find_first_of("[];") != std::string::npos) {
    throw Error("8 numbers are wanted: time tx ty tz qx qy qz qw");
  }
  const Eigen::Quaterniond q((*n)[7], (*n)[4], (*n)[5], (*n)[6]);
  if (!(std::abs(q.norm() - 1) < 0.01)) {
    throw Error(fmt::format("the quaternion has length {:.4g}, not 1", q.norm()));
  }
  StampedPose pose;
  pose.time = (*n)[0];
  pose.world_from_camera =
      Eigen::Translation3d((*n)[1], (*n)[2], (*n)[3]) * Eigen::Quaterniond(q.normalized());
  return pose;
}

}  // namespace

std::string trajectory_line(const StampedPose& pose) {
  const Eigen::Vector3d t = pose.world_from_camera.translation();
  const Eigen::Quaterniond q(pose.world_from_camera.linear());
  return fmt::format("{:.6f} {:.7f} {:.7f} {:.7f} {:.9f} {:.9f} {:.9f} {:.9f}\n", pose.time, t.x(),
                     t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

std::vector<StampedPose> read_trajectory(const std::filesystem::path& path) {
  std::vector<StampedPose> poses;
  for_each_line(path, [&](const std::string& line) {
    if (line.front() == '#') return;
    const StampedPose pose = stamped_pose_of(line);
    if (!poses.empty() && !(pose.time > poses.back().time)) {
      throw Error(
          fmt::format("times must rise: {} s comes after {} s", pose.time, poses.back().time));
    }
    poses.push_back(pose);
  });
  return poses;
}

}  // namespace palpable
