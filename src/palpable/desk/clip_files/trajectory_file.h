/// @file
/// The way of a camera, trajectory.txt of truths and results: a line per pose in the format of
/// TUM's RGB-D benchmark,
///
///     time tx ty tz qx qy qz qw        seconds, metres, a unit quaternion: world_from_camera
///
/// and remarks that begin with #. The numbers are separated by spaces, tabs or commas, as TUM's own
/// tools read them.
#pragma once

#include "palpable/common/geometry/stamped_pose.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The remark with which a result's file begins.
inline constexpr std::string_view kTrajectoryRemark =
    "# time tx ty tz qx qy qz qw: world_from_camera of the rectified left camera\n";

/// One line, its end included.
[[nodiscard]] std::string trajectory_line(const StampedPose& pose);

/// @throws Error naming file and line: not eight finite numbers, a quaternion that is not of length
/// 1 (within 1 %), times that do not rise
[[nodiscard]] std::vector<StampedPose> read_trajectory(const std::filesystem::path& path);

}  // namespace palpable
