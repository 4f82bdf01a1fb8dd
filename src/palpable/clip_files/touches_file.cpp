#include "palpable/clip_files/touches_file.h"

#include "palpable/base/error.h"
#include "palpable/clip_files/json_lines.h"

#include <fmt/core.h>

namespace palpable {

std::string touch_line(const TouchLine& touch) {
  std::string text = fmt::format("{{\"frame\":{}", touch.frame);
  if (touch.time) text += fmt::format(",\"time\":{:.6f}", *touch.time);
  if (touch.site >= 0) text += fmt::format(",\"site\":{}", touch.site);
  if (touch.level) text += fmt::format(",\"level\":{:.6f}", *touch.level);
  if (touch.force) text += fmt::format(",\"force\":{:.6f}", *touch.force);
  if (touch.press_depth) text += fmt::format(",\"press_depth\":{:.7f}", *touch.press_depth);
  if (touch.point) {
    text += fmt::format(",\"point\":[{:.6f},{:.6f},{:.6f}]", touch.point->x(), touch.point->y(),
                        touch.point->z());
  }
  return text + "}\n";
}

std::vector<TouchLine> read_touches(const std::filesystem::path& path) {
  std::vector<TouchLine> touches;
  for_each_object(path, [&](const JsonObject& line) {
    TouchLine touch;
    if (line.has("site")) touch.site = line.whole("site");
    if (touch.site < -1) throw Error(fmt::format("site {} is no site", touch.site));
    if (line.has("level")) {
      touch.level = line.number_if_any("level");
      if (!touch.level) throw Error("level is no number");
      if (*touch.level < 0) throw Error("level is negative: it is a share of the site's full load");
    }
    touch.frame = line.frame();
    touch.time = line.number_if_any("time");
    touch.force = line.number_if_any("force");
    touch.press_depth = line.number_if_any("press_depth");
    if (const auto p = line.numbers_if_any("point", 3)) {
      touch.point = Eigen::Vector3d((*p)[0], (*p)[1], (*p)[2]);
    }
    touches.push_back(touch);
  });
  return touches;
}

}  // namespace palpable
