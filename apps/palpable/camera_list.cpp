#include "apps/palpable/camera_list.h"

#include "apps/common/json.h"
#include "palpable/base/error.h"
#include "palpable/sources/camera_source.h"
#include "palpable/sources/side_by_side.h"
#include "palpable/sources/v4l2_camera.h"

#include <fmt/core.h>

namespace palpable::app {
namespace {

using Folders = std::vector<std::filesystem::path>;

struct Found {
  CameraInfo info;
  std::string trouble;  // why it could not be asked
};

std::string rates_text(const CameraMode& mode) {
  std::string text;
  for (const double rate : mode.rates)
    text += fmt::format("{}{:g}", text.empty() ? "" : ", ", rate);
  return text.empty() ? "?" : text;
}

// What its pictures are taken to be.
const char* kind_of(const CameraMode& mode) {
  if (is_depth_format(mode.format)) return "depth";
  return looks_side_by_side(mode.width, mode.height) ? "both eyes side by side" : "one eye";
}

bool has_depth(const CameraInfo& info) {
  for (const CameraMode& mode : info.modes) {
    if (is_depth_format(mode.format)) return true;
  }
  return false;
}

// The calibration that live would take, for the mode that it would choose.
std::string calibration_text(const CameraInfo& info, const Folders& folders) {
  const CameraMode* mode = side_by_side_mode(info);
  if (mode == nullptr) return {};
  const auto known = known_calibration(info.name, mode->width / 2, mode->height, folders);
  return known ? known->string() : std::string();
}

std::string use_of(const CameraInfo& info) {
  if (side_by_side_mode(info) != nullptr) {
    return fmt::format("palpable live BODY --source {}", info.path);
  }
  if (has_depth(info)) {
    return fmt::format(
        "palpable live BODY --source DEVICE --depth {}, where DEVICE has the same view", info.path);
  }
  return fmt::format("palpable live BODY --source {} --right DEVICE, where DEVICE is the right eye",
                     info.path);
}

std::string text_of(const CameraInfo& info, const Folders& folders) {
  std::string text = fmt::format("{}  {}  ({})\n", info.path, info.name, info.bus);
  for (const CameraMode& mode : info.modes) {
    text += fmt::format("  {:>9}  {:<4}  {:<22}  {} fps\n",
                        fmt::format("{}x{}", mode.width, mode.height), letters_of(mode.format),
                        kind_of(mode), rates_text(mode));
  }
  if (info.modes.empty()) return text + "  no picture format that can be read\n";
  text += fmt::format("  exposure {}, gain {}\n",
                      info.has_exposure ? "can be fixed" : "cannot be fixed",
                      info.has_gain ? "can be fixed" : "cannot be fixed");
  if (side_by_side_mode(info) != nullptr) {
    const std::string calibration = calibration_text(info, folders);
    text += fmt::format(
        "  calibration: {}\n",
        calibration.empty()
            ? fmt::format("none known; palpable calibrate --source {} makes one", info.path)
            : calibration);
  }
  return text + fmt::format("  use: {}\n", use_of(info));
}

Json json_of(const Found& found, const Folders& folders) {
  Json camera;
  camera["device"] = found.info.path;
  if (!found.trouble.empty()) {
    camera["trouble"] = found.trouble;
    return camera;
  }
  camera["name"] = found.info.name;
  camera["bus"] = found.info.bus;
  camera["modes"] = Json::array();
  for (const CameraMode& mode : found.info.modes) {
    camera["modes"].push_back({{"width", mode.width},
                               {"height", mode.height},
                               {"format", letters_of(mode.format)},
                               {"kind", kind_of(mode)},
                               {"fps", mode.rates}});
  }
  camera["exposure"] = found.info.has_exposure;
  camera["gain"] = found.info.has_gain;
  const std::string calibration = calibration_text(found.info, folders);
  camera["calibration"] = calibration.empty() ? Json(nullptr) : Json(calibration);
  return camera;
}

}  // namespace

std::string camera_list(VideoSystem& system, const Folders& folders, bool json) {
  std::vector<Found> found;
  for (const std::string& path : system.devices()) {
    const Result<CameraInfo> info = ask_camera(system, path);
    Found& entry = found.emplace_back();
    entry.info.path = path;
    if (info.ok()) {
      entry.info = info.value();
    } else {
      entry.trouble = info.problem().message;
    }
  }
  if (json) {
    Json result = Json::array();
    for (const Found& entry : found) result.push_back(json_of(entry, folders));
    return Json{{"cameras", result}}.dump(2) + "\n";
  }
  if (found.empty()) {
    return "no camera: there is no /dev/video* (is it plugged in, and passed on to a container?)\n"
           "What needs none: a folder of images, a video file, --source synthetic; see palpable "
           "live --help\n";
  }
  std::string text;
  for (const Found& entry : found)
    text += entry.trouble.empty() ? text_of(entry.info, folders) : entry.trouble + "\n";
  return text;
}

}  // namespace palpable::app
