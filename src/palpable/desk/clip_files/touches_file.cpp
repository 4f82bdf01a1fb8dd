#include "palpable/desk/clip_files/touches_file.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/json_lines.h"

#include <fmt/format.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

std::string text_of(const Eigen::Vector3d& v) {
  return fmt::format("[{:.6f},{:.6f},{:.6f}]", v.x(), v.y(), v.z());
}

// A JSON object with the known values.
std::string touch_text(const FeltTouch& touch) {
  std::string text;
  const auto add = [&](const char* key, const std::string& value) {
    text += fmt::format("{}\"{}\":{}", text.empty() ? "" : ",", key, value);
  };
  if (touch.site >= 0) add("site", fmt::format("{}", touch.site));
  if (touch.level) add("level", fmt::format("{:.6f}", *touch.level));
  if (touch.press_depth) add("press_depth", fmt::format("{:.7f}", *touch.press_depth));
  if (touch.force) add("force", text_of(*touch.force));
  if (touch.point) add("point", text_of(*touch.point));
  if (touch.time) add("time", fmt::format("{:.6f}", *touch.time));
  if (touch.area) add("area", fmt::format("{:.9f}", *touch.area));
  if (touch.assumed) add("assumed", fmt::format("{:.4f}", *touch.assumed));
  if (!touch.by.empty()) add("by", quoted_text(touch.by));
  return fmt::format("{{{}}}", text);
}

// The values that an old line with one touch and an entry of a list have in common.
FeltTouch touch_of(const JsonObject& object) {
  FeltTouch touch;
  if (object.has("site")) touch.site = object.whole("site");
  if (touch.site < -1) throw Error(fmt::format("site {} is no site", touch.site));
  if (object.has("level")) {
    touch.level = object.number_if_any("level");
    if (!touch.level) throw Error("level is no number");
    if (*touch.level < 0) throw Error("level is negative: it is a share of the site's full load");
  }
  touch.press_depth = object.number_if_any("press_depth");
  if (const auto p = object.numbers_if_any("point", 3)) touch.point = vector_of(*p);
  touch.time = object.number_if_any("time");
  touch.area = object.number_if_any("area");
  touch.assumed = object.number_if_any("assumed");
  if (object.has("by")) touch.by = object.text("by");
  return touch;
}

}  // namespace

std::string touches_line(const TouchesLine& line) {
  std::vector<std::string> list;
  for (const FeltTouch& touch : line.touches) list.push_back(touch_text(touch));
  std::string text = fmt::format("{{\"frame\":{}", line.frame);
  if (!line.body.empty()) text += fmt::format(",\"body\":{}", quoted_text(line.body));
  text += fmt::format(",\"touches\":[{}]", fmt::join(list, ","));
  const auto add = [&](const char* key, const std::optional<double>& error) {
    if (error) text += fmt::format(",\"{}\":{:.5f}", key, *error);
  };
  add("displacement_error", line.displacement_error);
  add("stress_error", line.stress_error);
  return text + "}\n";
}

std::vector<TouchesLine> read_touches(const std::filesystem::path& path, const std::string& body) {
  std::map<int, TouchesLine> by_frame;
  for_each_object(path, [&](const JsonObject& line) {
    if (is_of_another(line, body)) return;
    TouchesLine& felt = by_frame[line.frame()];
    felt.frame = line.frame();
    felt.body = body;
    std::vector<FeltTouch>& touches = felt.touches;
    if (line.has("displacement_error")) {
      felt.displacement_error = line.number_if_any("displacement_error");
    }
    if (line.has("stress_error")) felt.stress_error = line.number_if_any("stress_error");
    if (!line.has("touches")) {
      touches.push_back(touch_of(line));
      return;
    }
    line.for_each_in("touches", [&](const JsonObject& entry) {
      touches.push_back(touch_of(entry));
      if (entry.has("force")) touches.back().force = vector_of(entry.numbers("force", 3));
    });
  });
  std::vector<TouchesLine> lines;
  for (auto& [frame, felt] : by_frame) lines.push_back(std::move(felt));
  return lines;
}

}  // namespace palpable
