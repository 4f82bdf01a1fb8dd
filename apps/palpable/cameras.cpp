// palpable cameras: what is plugged in, and what it can do.

#include "apps/palpable/commands.h"
#include "apps/palpable/source_options.h"
#include "palpable/base/error.h"
#include "palpable/vision/camera_source.h"
#include "palpable/vision/side_by_side.h"
#include "palpable/vision/v4l2_camera.h"

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

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
std::string calibration_text(const CameraInfo& info) {
  const CameraMode* mode = side_by_side_mode(info);
  if (mode == nullptr) return {};
  const auto known =
      known_calibration(info.name, mode->width / 2, mode->height, calibration_folders());
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

void print_camera(const CameraInfo& info) {
  fmt::print("{}  {}  ({})\n", info.path, info.name, info.bus);
  for (const CameraMode& mode : info.modes) {
    fmt::print("  {:>9}  {:<4}  {:<22}  {} fps\n", fmt::format("{}x{}", mode.width, mode.height),
               letters_of(mode.format), kind_of(mode), rates_text(mode));
  }
  if (info.modes.empty()) {
    fmt::print("  no picture format that can be read\n");
    return;
  }
  fmt::print("  exposure {}, gain {}\n", info.has_exposure ? "can be fixed" : "cannot be fixed",
             info.has_gain ? "can be fixed" : "cannot be fixed");
  if (side_by_side_mode(info) != nullptr) {
    const std::string calibration = calibration_text(info);
    fmt::print("  calibration: {}\n",
               calibration.empty()
                   ? fmt::format("none known; palpable calibrate --source {} makes one", info.path)
                   : calibration);
  }
  fmt::print("  use: {}\n", use_of(info));
}

nlohmann::ordered_json json_of(const Found& found) {
  nlohmann::ordered_json camera;
  camera["device"] = found.info.path;
  if (!found.trouble.empty()) {
    camera["trouble"] = found.trouble;
    return camera;
  }
  camera["name"] = found.info.name;
  camera["bus"] = found.info.bus;
  camera["modes"] = nlohmann::ordered_json::array();
  for (const CameraMode& mode : found.info.modes) {
    camera["modes"].push_back({{"width", mode.width},
                               {"height", mode.height},
                               {"format", letters_of(mode.format)},
                               {"kind", kind_of(mode)},
                               {"fps", mode.rates}});
  }
  camera["exposure"] = found.info.has_exposure;
  camera["gain"] = found.info.has_gain;
  const std::string calibration = calibration_text(found.info);
  camera["calibration"] =
      calibration.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(calibration);
  return camera;
}

void cameras(bool json) {
  VideoSystem& system = linux_video();
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
    nlohmann::ordered_json result = nlohmann::ordered_json::array();
    for (const Found& entry : found) result.push_back(json_of(entry));
    fmt::print("{}\n", nlohmann::ordered_json{{"cameras", result}}.dump(2));
    return;
  }
  if (found.empty()) {
    fmt::print(
        "no camera: there is no /dev/video* (is it plugged in, and passed on to a container?)\n"
        "What needs none: a folder of images, a video file, --source synthetic; see palpable live "
        "--help\n");
    return;
  }
  for (const Found& entry : found) {
    if (entry.trouble.empty()) {
      print_camera(entry.info);
    } else {
      fmt::print("{}\n", entry.trouble);
    }
  }
}

}  // namespace

void add_cameras(CLI::App& app) {
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("cameras", "What is plugged in, and what it can do");
  command->add_flag("--json", *json, "One JSON object on stdout");
  command->footer(
      "Sizes, formats and rates of each device, whether its picture looks like two eyes side by\n"
      "side, whether exposure and gain can be fixed, and the calibration that is known of it.\n"
      "Example: palpable cameras");
  command->callback([json] { cameras(*json); });
}

}  // namespace palpable::app
