/// @file
/// The path of a camera, trajectory.txt of a truth and of a result: one line per pose in the format
/// of TUM's RGB-D benchmark,
///
///     time tx ty tz qx qy qz qw        seconds, metres, a unit quaternion: world_from_camera
///
/// and comments that begin with #. The numbers are separated by spaces, tabs or commas, as TUM's
/// own tools read them.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The comment at the top of a result's file.
inline constexpr std::string_view kTrajectoryRemark =
    "# time tx ty tz qx qy qz qw: world_from_camera of the rectified left camera\n";

/// One line, including its line end.
[[nodiscard]] std::string trajectory_line(const StampedPose& pose);

/// @throws Error naming file and line: not eight finite numbers, a quaternion whose length is not 1
/// within 1 %, times that do not increase
[[nodiscard]] std::vector<StampedPose> read_trajectory(const std::filesystem::path& path);

}  // namespace palpable
