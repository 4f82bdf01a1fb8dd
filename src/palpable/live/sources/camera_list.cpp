#include "palpable/live/sources/camera_list.h"

#include "palpable/common/base/error.h"
#include "palpable/live/sources/camera_source.h"
#include "palpable/live/sources/side_by_side.h"

#include <fmt/core.h>

#include <algorithm>

namespace palpable {
namespace {

std::string rates_text(const CameraMode& mode) {
  std::string text;
  for (const double rate : mode.rates)
    text += fmt::format("{}{:g}", text.empty() ? "" : ", ", rate);
  return text.empty() ? "?" : text;
}

// Kind of pictures of one mode, for the list.
const char* kind_of(const CameraMode& mode) {
  if (is_depth_format(mode.format)) return "depth";
  return looks_side_by_side(mode.width, mode.height) ? "both eyes side by side" : "one eye";
}

CameraKind kind_of(const CameraInfo& info) {
  if (info.modes.empty()) return CameraKind::kUnreadable;
  if (side_by_side_mode(info) != nullptr) return CameraKind::kSideBySide;
  const bool has_depth =
      std::any_of(info.modes.begin(), info.modes.end(),
                  [](const CameraMode& mode) { return is_depth_format(mode.format); });
  return has_depth ? CameraKind::kDepth : CameraKind::kOneEye;
}

Json json_of(const ListedCamera& listed) {
  Json camera;
  camera["device"] = listed.info.path;
  if (!listed.trouble.empty()) {
    camera["trouble"] = listed.trouble;
    return camera;
  }
  camera["name"] = listed.info.name;
  camera["bus"] = listed.info.bus;
  camera["modes"] = Json::array();
  for (const CameraMode& mode : listed.info.modes) {
    camera["modes"].push_back({{"width", mode.width},
                               {"height", mode.height},
                               {"format", letters_of(mode.format)},
                               {"kind", kind_of(mode)},
                               {"fps", mode.rates}});
  }
  camera["exposure"] = listed.info.has_exposure;
  camera["gain"] = listed.info.has_gain;
  camera["calibration"] =
      listed.calibration.empty() ? Json(nullptr) : Json(listed.calibration.string());
  return camera;
}

}  // namespace

std::vector<ListedCamera> list_cameras(VideoSystem& system,
                                       const std::vector<std::filesystem::path>& folders) {
  std::vector<ListedCamera> cameras;
  for (const std::string& path : system.devices()) {
    const Result<CameraInfo> info = query_camera(system, path);
    ListedCamera& camera = cameras.emplace_back();
    camera.info.path = path;
    if (!info.ok()) {
      camera.trouble = info.problem().message;
      continue;
    }
    camera.info = info.value();
    camera.kind = kind_of(camera.info);
    if (const CameraMode* mode = side_by_side_mode(camera.info)) {
      camera.calibration =
          known_calibration(camera.info.name, mode->width / 2, mode->height, folders)
              .value_or(std::filesystem::path());
    }
  }
  return cameras;
}

std::string text_of(const ListedCamera& camera) {
  if (!camera.trouble.empty()) return camera.trouble + "\n";
  const CameraInfo& info = camera.info;
  std::string text = fmt::format("{}  {}  ({})\n", info.path, info.name, info.bus);
  for (const CameraMode& mode : info.modes) {
    text += fmt::format("  {:>9}  {:<4}  {:<22}  {} fps\n",
                        fmt::format("{}x{}", mode.width, mode.height), letters_of(mode.format),
                        kind_of(mode), rates_text(mode));
  }
  if (info.modes.empty()) return text + "  no picture format that can be read\n";
  return text + fmt::format("  exposure {}, gain {}\n",
                            info.has_exposure ? "can be fixed" : "cannot be fixed",
                            info.has_gain ? "can be fixed" : "cannot be fixed");
}

Json json_of(const std::vector<ListedCamera>& cameras) {
  Json list = Json::array();
  for (const ListedCamera& camera : cameras) list.push_back(json_of(camera));
  return Json{{"cameras", list}};
}

}  // namespace palpable
