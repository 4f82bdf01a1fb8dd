/// @file
/// The way of a camera as data sets publish it. Read are
///
///   TUM       a line `time tx ty tz qx qy qz qw` for each pose (trajectory_file.h), of the colour
///   KITTI     12 numbers for each frame, the rows of world_from_camera; times from times.txt
///   beside
///             it, else frames at 10 Hz
///   7-Scenes  frame-N.pose.txt, 4 x 4 numbers; N in order, at 30 Hz; of the depth camera
///   EuRoC     data.csv of state_groundtruth_estimate0: ns, position, quaternion w x y z, of the
///             body, unless cam0/sensor.yaml beside its folder says where the left camera is
///
/// or the folder of a recording that sources/folder_layouts.h recognises, with poses in it.
#pragma once

#include "palpable/common/geometry/stamped_pose.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct PublishedPoses {
  std::string format;              ///< "TUM", "KITTI", "7-Scenes" or "EuRoC"
  std::string of;                  ///< whose poses they are: "left camera", "depth camera", "body"
  std::vector<StampedPose> poses;  ///< at least two; times rise, by the recording's own clock
};

/// @param path  a file or a folder
/// @param rate  Hz, of files without times; nothing: the format's usual one
/// @throws Error naming the file, and its line where there is one, that is none of these
[[nodiscard]] PublishedPoses read_published_poses(const std::filesystem::path& path,
                                                  std::optional<double> rate = {});

}  // namespace palpable
