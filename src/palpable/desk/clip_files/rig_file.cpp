#include "palpable/desk/clip_files/rig_file.h"

#include "palpable/desk/clip_files/json_lines.h"

#include <fmt/core.h>

namespace palpable {

std::string rig_line(const RigLine& rig) {
  return fmt::format("{{\"frame\":{},\"row_offset_px\":{:.4f}{}}}\n", rig.frame, rig.row_offset_px,
                     rig.step ? ",\"step\":true" : "");
}

std::vector<RigLine> read_rig(const std::filesystem::path& path) {
  std::vector<RigLine> lines;
  for_each_object(path, [&](const JsonObject& line) {
    const int frame = line.frame_after(lines.empty() ? -1 : lines.back().frame);
    lines.push_back({frame, line.number("row_offset_px"), line.flag_or("step", false)});
  });
  return lines;
}

}  // namespace palpable
