/// @file
/// pose.jsonl of a result: where the body was drawn, a line per frame,
///
///     {"frame":7,"camera_from_body":[1,0,0,0.1,0,1,0,0.2,0,0,1,0.4,0,0,0,1]}
///
/// with the 16 numbers row by row. Of several bodies each has a line, which names it:
/// "body":"upper".
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

struct PoseLine {
  int frame = 0;
  Rigid3 camera_from_body = Rigid3::Identity();
  std::string body = {};  ///< which of several; empty: there is one
};

/// One line, its end included.
[[nodiscard]] std::string pose_line(const PoseLine& pose);

/// @param body  lines that name another one are left out
/// @throws Error naming file and line when frames do not rise or a pose is no rigid motion
[[nodiscard]] std::vector<PoseLine> read_poses(const std::filesystem::path& path,
                                               const std::string& body = {});

}  // namespace palpable
