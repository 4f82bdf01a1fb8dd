/// @file
/// The path of a camera as data sets publish it. These formats are read:
///
///     TUM       a line `time tx ty tz qx qy qz qw` per pose (trajectory_file.h), of the
///               colour camera
///     KITTI     12 numbers per frame, the rows of world_from_camera, of the left camera;
///               times from times.txt beside the file, else frames at 10 Hz
///     7-Scenes  frame-N.pose.txt, 4 x 4 numbers, in the order of N, frames at 30 Hz; of the
///               depth camera
///     EuRoC     data.csv of state_groundtruth_estimate0: ns, position, quaternion w x y z;
///               of the left camera if cam0/sensor.yaml beside its folder gives its pose in
///               the body, else of the body
///
/// A folder of a recording with poses that sources/folder_layouts.h recognises is read, too.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct PublishedPoses {
  std::string format;              ///< "TUM", "KITTI", "7-Scenes" or "EuRoC"
  std::string of;                  ///< whose path it is: "left camera", "depth camera" or "body"
  std::vector<StampedPose> poses;  ///< at least two; times increase, s of the recording's clock
};

/// @param path  a file or a folder
/// @param rate  Hz, for files without times; nothing: the usual rate of the format
/// @throws Error naming the file, and the line if there is one, that has none of these formats
[[nodiscard]] PublishedPoses read_published_poses(const std::filesystem::path& path,
                                                  std::optional<double> rate = {});

}  // namespace palpable
