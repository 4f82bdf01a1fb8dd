#include "palpable/live/sources/camera_list.h"

#include "palpable/common/base/error.h"
#include "palpable/live/sources/camera_choice.h"
#include "palpable/live/sources/camera_source.h"
#include "palpable/live/sources/raw_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>

namespace palpable {
namespace {

std::string rates_text(const CameraMode& mode) {
  std::string text;
  if (mode.has_rates_between && !mode.rates.empty()) {
    return fmt::format("{:g} to {:g}", mode.rates.back(), mode.rates.front());
  }
  for (const double rate : mode.rates)
    text += fmt::format("{}{:g}", text.empty() ? "" : ", ", rate);
  return text.empty() ? "?" : text;
}

// Kind of pictures of one mode, for the list.
const char* kind_of(const CameraMode& mode) {
  if (is_depth_format(mode.format)) return "depth";
  if (is_gray16_format(mode.format)) return "infrared, codes, depth";
  if (is_interleaved_format(mode.format)) return "both eyes interleaved";
  return is_side_by_side(mode) ? "both eyes side by side" : "one eye";
}

CameraKind kind_of(const CameraInfo& info) {
  if (info.modes.empty()) return CameraKind::kUnreadable;
  if (side_by_side_mode(info) != nullptr) return CameraKind::kSideBySide;
  const auto has = [&](bool (*is_one)(std::uint32_t)) {
    return std::any_of(info.modes.begin(), info.modes.end(),
                       [&](const CameraMode& mode) { return is_one(mode.format); });
  };
  if (has(is_interleaved_format)) return CameraKind::kInterleaved;
  if (has(is_depth_format)) return CameraKind::kDepth;
  return has(is_color_format) ? CameraKind::kOneEye : CameraKind::kGray16;
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
  camera["may_slow_down"] = listed.info.may_slow_down;
  camera["usb_megabits"] =
      listed.info.usb.megabits > 0 ? Json(listed.info.usb.megabits) : Json(nullptr);
  camera["users"] = listed.users;
  camera["calibration"] =
      listed.calibration.empty() ? Json(nullptr) : Json(listed.calibration.string());
  return camera;
}

// The device of the same camera for the colours of a depth device. A RealSense's infrared picture,
// which is grey, has the view of its depth, its colour picture has not.
std::string pictures_of(const CameraInfo& depth, const std::vector<ListedCamera>& cameras) {
  std::string found;
  for (const ListedCamera& other : cameras) {
    if (depth.bus.empty() || other.info.bus != depth.bus || other.info.path == depth.path) continue;
    const auto has = [&](auto is_one) {
      return std::any_of(other.info.modes.begin(), other.info.modes.end(),
                         [&](const CameraMode& mode) { return is_one(mode.format); });
    };
    if (has([](std::uint32_t format) { return format == four_letters("GREY"); })) {
      return other.info.path;
    }
    if (found.empty() && has(is_color_format)) found = other.info.path;
  }
  return found;
}

// What may disturb, one line each.
std::string remarks_on(const ListedCamera& camera) {
  const CameraInfo& info = camera.info;
  std::string text;
  if (info.usb.megabits > 0) {
    text += fmt::format("  USB: {:g} Mbit/s{}\n", info.usb.megabits, usb_hint(info.usb));
  }
  if (info.may_slow_down) {
    text +=
        "  in dim light it takes fewer pictures a second (exposure_dynamic_framerate; palpable "
        "switches it off when that happens)\n";
  }
  if (!camera.users.empty()) text += fmt::format("  opened by {}\n", camera.users);
  return text;
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
      camera.is_data = is_data_device(system, path);
      continue;
    }
    camera.info = info.value();
    camera.kind = kind_of(camera.info);
    camera.users = system.users(path);
    if (const auto eye = size_of_two_eyes(camera.info)) {
      camera.calibration = known_calibration(camera.info.name, eye->width, eye->height, folders)
                               .value_or(std::filesystem::path());
    }
  }
  for (ListedCamera& camera : cameras) {
    if (camera.kind == CameraKind::kDepth) camera.pictures = pictures_of(camera.info, cameras);
  }
  return cameras;
}

std::string text_of(const ListedCamera& camera) {
  if (!camera.trouble.empty()) return camera.trouble + "\n";
  const CameraInfo& info = camera.info;
  std::string text = fmt::format("{}  {}  ({})\n", info.path, info.name, info.bus);
  for (const CameraMode& mode : info.modes) {
    text +=
        fmt::format("  {:>9}  {:<4}  {:<22}  {} fps\n",
                    (mode.steps ? "up to " : "") + fmt::format("{}x{}", mode.width, mode.height),
                    letters_of(mode.format), kind_of(mode), rates_text(mode));
  }
  if (info.modes.empty()) return text + "  no picture format that can be read\n";
  return text +
         fmt::format("  exposure {}, gain {}\n",
                     info.has_exposure ? "can be fixed" : "cannot be fixed",
                     info.has_gain ? "can be fixed" : "cannot be fixed") +
         remarks_on(camera);
}

Json json_of(const std::vector<ListedCamera>& cameras) {
  Json list = Json::array();
  for (const ListedCamera& camera : cameras) list.push_back(json_of(camera));
  return Json{{"cameras", list}};
}

}  // namespace palpable
