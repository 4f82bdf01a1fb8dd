/// @file
/// The path of a camera: trajectory.txt of a truth and of a result, and paths that data sets
/// publish.
///
/// trajectory.txt has one line per pose in the format of TUM's RGB-D benchmark,
///
///     time tx ty tz qx qy qz qw        seconds, metres, a unit quaternion: world_from_camera
///
/// and comments that begin with #. The numbers are separated by spaces, tabs or commas, as TUM's
/// own tools read them.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The comment at the top of a result's file.
inline constexpr std::string_view kTrajectoryRemark =
    "# time tx ty tz qx qy qz qw: world_from_camera of the rectified left camera\n";

/// One line, including its line end.
[[nodiscard]] std::string trajectory_line(const StampedPose& pose);

/// @throws Error naming file and line when a line does not hold eight finite numbers, when the
/// length of a quaternion differs from 1 by more than 1 %, when times do not increase or cannot be
/// seconds (time_stamps.h), or when the camera's median speed exceeds 200 m/s: then its positions
/// are in mm
[[nodiscard]] std::vector<StampedPose> read_trajectory(const std::filesystem::path& path);

/// The path of a camera as data sets publish it. These formats are read:
///
///     TUM       a line `time tx ty tz qx qy qz qw` per pose (read_trajectory()), of the
///               colour camera
///     KITTI     12 numbers per frame, the rows of world_from_camera, of the left camera;
///               times from times.txt beside the file, else frames at 10 Hz
///     7-Scenes  frame-N.pose.txt, 4 x 4 numbers, in the order of N, frames at 30 Hz; of the
///               depth camera
///     EuRoC     data.csv of state_groundtruth_estimate0: ns, position, quaternion w x y z;
///               of the left camera if cam0/sensor.yaml beside its folder gives its pose in
///               the body, else of the body
///
/// Stray Scanner's odometry.csv and Record3D's metadata.json are read with their folders.
/// A folder of a recording with poses that sources/folder_layouts.h recognises is read, too.
struct PublishedPoses {
  std::string format;              ///< "TUM", "KITTI", "7-Scenes" or "EuRoC"
  std::string of;                  ///< whose path it is: "left camera", "depth camera" or "body"
  std::vector<StampedPose> poses;  ///< at least two; times increase, s of the recording's clock
};

/// @param path  a file or a folder
/// @param rate  Hz, for files without times; nothing: the usual rate of the format
/// @throws Error naming the file, and the line if there is one, when the file has none of these
/// formats, when its times cannot be seconds (steps of 10 to 1000 in whole numbers are
/// milliseconds), or when its positions cannot be metres, as in read_trajectory()
[[nodiscard]] PublishedPoses read_published_poses(const std::filesystem::path& path,
                                                  std::optional<double> rate = {});

}  // namespace palpable
