#include "palpable/desk/clip_files/deformed_file.h"

#include "palpable/desk/clip_files/frame_names.h"
#include "palpable/desk/clip_files/json_lines.h"

#include <fmt/core.h>

#include <map>
#include <system_error>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// A JSON list of three numbers. Callers keep micrometres (6 digits) and nanonewtons (9), which is
// finer than the accuracy of any solution.
std::string three(const Eigen::Vector3d& v, int digits) {
  return fmt::format("[{:.{}f},{:.{}f},{:.{}f}]", v.x(), digits, v.y(), digits, v.z(), digits);
}

}  // namespace

std::string deformed_line(const DeformedLine& line) {
  std::string text = fmt::format("{{\"frame\":{},\"body\":{},\"depth_m\":{:.6f},\"force\":{}",
                                 line.frame, line.body, line.depth, three(line.force, 9));
  if (line.point) text += fmt::format(",\"point\":{}", three(*line.point, 6));
  text += fmt::format(",\"scored\":{}", line.scored);
  if (!line.why.empty()) text += ",\"why\":" + quoted_text(line.why);
  return text + "}\n";
}

std::vector<DeformedLine> read_deformed_lines(const fs::path& folder) {
  const fs::path path = folder / "deformed.jsonl";
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  std::map<int, DeformedLine> lines;
  for_each_object(path, [&](const JsonObject& object) {
    DeformedLine line;
    line.frame = object.frame();
    line.body = object.whole_or("body", 0);
    line.depth = object.number("depth_m");
    line.force = vector_of(object.numbers("force", 3));
    if (object.has("point")) line.point = vector_of(object.numbers("point", 3));
    line.scored = object.flag("scored");
    if (object.has("why")) line.why = object.text("why");
    lines[line.frame] = line;
  });
  std::vector<DeformedLine> in_order;
  for (const auto& [frame, line] : lines) in_order.push_back(line);
  return in_order;
}

fs::path deformed_skin_file(const fs::path& folder, int frame) {
  return folder / frame_name(frame, ".ply");
}

}  // namespace palpable
