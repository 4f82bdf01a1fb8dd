#include "palpable/desk/clip_files/pose_file.h"

#include "palpable/desk/clip_files/json_lines.h"

#include <fmt/core.h>

namespace palpable {

std::string pose_line(const PoseLine& pose) {
  std::string name;
  if (!pose.body.empty()) name = fmt::format(",\"body\":{}", quoted_text(pose.body));
  return fmt::format("{{\"frame\":{}{},\"camera_from_body\":{}}}\n", pose.frame, name,
                     rows_text(pose.camera_from_body, 9));
}

std::vector<PoseLine> read_poses(const std::filesystem::path& path, const std::string& body) {
  std::vector<PoseLine> poses;
  for_each_object(path, [&](const JsonObject& line) {
    if (is_of_another(line, body)) return;
    const int frame = line.frame_after(poses.empty() ? -1 : poses.back().frame);
    poses.push_back({frame, line.rigid("camera_from_body"), body});
  });
  return poses;
}

}  // namespace palpable
