/// @file
/// pose.jsonl of a result: the pose in which the body was drawn, one line per frame:
///
///     {"frame":7,"camera_from_body":[1,0,0,0.1,0,1,0,0.2,0,0,1,0.4,0,0,0,1]}
///
/// The 16 numbers are the matrix row by row. If there are several bodies, each has a line per frame
/// that names it: "body":"upper".
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

struct PoseLine {
  int frame = 0;
  Rigid3 camera_from_body = Rigid3::Identity();
  std::string body = {};  ///< name of the body; empty: there is only one
};

/// One line, including its line end.
[[nodiscard]] std::string pose_line(const PoseLine& pose);

/// @param body  lines that name another body are skipped
/// @throws Error naming file and line when frame numbers do not increase or a pose is no rigid
/// motion
[[nodiscard]] std::vector<PoseLine> read_poses(const std::filesystem::path& path,
                                               const std::string& body = {});

}  // namespace palpable
