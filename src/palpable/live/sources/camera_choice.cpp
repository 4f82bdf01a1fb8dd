#include "palpable/live/sources/camera_choice.h"

#include "palpable/live/sources/side_by_side.h"
#include "palpable/live/sources/source_calibration.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace palpable {
namespace {

constexpr int kPreferredWidth = 2560;  // px, both eyes
constexpr int kPreferredHeight = 720;  // px

bool offers(const UsedCamera& camera, const CameraMode& wanted) {
  return std::any_of(
      camera.info.modes.begin(), camera.info.modes.end(), [&](const CameraMode& mode) {
        return serves(mode.format, camera.use) && has_size(mode, wanted.width, wanted.height);
      });
}

bool any_serves(const CameraInfo& info, const CameraSettings& use) {
  return std::any_of(info.modes.begin(), info.modes.end(),
                     [&](const CameraMode& mode) { return serves(mode.format, use); });
}

// Whether the user, or the calibration, says what one step of a depth camera is. Y16 is then depth.
bool states_depth_unit(const CameraRequest& request) {
  if (request.depth_unit) return true;
  const Result<SourceCalibration> calibration =
      read_source_calibration(request.calibration, 0, 0, FrameFormat::Kind::kColorDepth);
  return calibration.ok() && calibration.value().depth_unit.has_value();
}

// How the pictures of the second device are used.
CameraSettings use_of_second(const CameraRequest& request) {
  CameraSettings use;
  use.depth = !request.depth.empty();
  use.y16_is_depth = use.depth && states_depth_unit(request);
  return use;
}

// Both eyes of one device that has no mode side by side.
bool is_interleaved(const CameraRequest& request, const CameraInfo& first) {
  CameraSettings use;
  use.interleaved = true;
  return request.right.empty() && request.depth.empty() && side_by_side_mode(first) == nullptr &&
         any_serves(first, use);
}

bool is_same_device(const std::string& path, const std::string& other) {
  std::error_code error;
  return path == other || std::filesystem::weakly_canonical(path, error) ==
                              std::filesystem::weakly_canonical(other, error);
}

// A first device without pictures for eyes or colour. The problem names the camera's device that
// has them.
std::optional<Problem> no_pictures(const CameraRequest& request, const CameraInfo& first,
                                   VideoSystem& system) {
  const CameraSettings colors;
  if (any_serves(first, colors) || is_interleaved(request, first)) return std::nullopt;
  CameraSettings interleaved;
  interleaved.interleaved = true;
  if (any_serves(first, interleaved)) {
    return Problem{
        fmt::format("{} ({}) has both eyes in one picture (Y8I, Y12I), and no picture of one eye: "
                    "leave out --right and --depth-source",
                    request.device, first.name)};
  }
  std::string text;
  if (first.modes.empty()) {
    text =
        fmt::format("{} ({}) has no picture format that can be read", request.device, first.name);
  } else {
    text = fmt::format(
        "{} ({}) gives depth or 16-bit grey, no colour or infrared: name it with --depth-source",
        request.device, first.name);
  }
  if (const auto other = other_device_of(first, colors, system)) {
    text += fmt::format("; the pictures of the same camera come from {}", other->path);
  }
  return Problem{text};
}

std::optional<CameraInfo> any_depth_of(const CameraInfo& camera, const CameraRequest& request,
                                       VideoSystem& system) {
  return other_device_of(camera, use_of_second(request), system);
}

// A depth camera that only has Y16, which nothing states to be depth.
std::optional<Problem> undeclared_depth(const CameraRequest& request, const CameraInfo& depth) {
  const CameraSettings use = use_of_second(request);
  CameraSettings with_y16 = use;
  with_y16.y16_is_depth = true;
  if (any_serves(depth, use) || !any_serves(depth, with_y16)) return std::nullopt;
  return Problem{fmt::format(
      "{} ({}) gives Y16, which is infrared or a maker's codes as often as depth: if it is depth, "
      "say what one step of it is with --depth-unit, such as 1mm, or unit_m in intrinsics.txt",
      depth.path, depth.name)};
}

// The depth device of a request; a note says if it is not the one that was named.
Result<CameraInfo> find_depth(const CameraRequest& request, const CameraInfo& first,
                              VideoSystem& system, std::vector<std::string>& notes) {
  if (request.depth == kDepthOfSameCamera) {
    if (const auto found = any_depth_of(first, request, system)) {
      notes.push_back(fmt::format("the depth comes from {} ({})", found->path, found->name));
      return *found;
    }
    return Problem{fmt::format(
        "--depth-source auto: no device of the camera {} ({}) has depth (Z16, or Y16 with "
        "--depth-unit); palpable cameras lists what each device has",
        request.device, first.name)};
  }
  Result<CameraInfo> named = query_camera(system, request.depth);
  const bool is_data = !named.ok() && is_data_device(system, request.depth);
  if (!named.ok() && !is_data) return named;
  if (named.ok() && any_serves(named.value(), use_of_second(request))) return named;
  if (const auto found = any_depth_of(named.ok() ? named.value() : first, request, system)) {
    notes.push_back(
        fmt::format("{} gives no depth; the same camera's depth, from {} ({}), is taken",
                    request.depth, found->path, found->name));
    return *found;
  }
  if (!named.ok()) return named;
  if (auto problem = undeclared_depth(request, named.value())) return *problem;
  return Problem{fmt::format(
      "{} ({}) gives no depth (Z16, or Y16 with --depth-unit), and neither does another device of "
      "the same camera; palpable cameras lists what each device has",
      request.depth, named.value().name)};
}

// A size that both devices have.
Result<EyeSize> common_size(const CameraRequest& request, const CameraInfo& first,
                            const CameraInfo& second) {
  const CameraSettings colors;
  const UsedCamera also{first, colors};
  const EyeSize size = comfortable_size(second, use_of_second(request), &also);
  if (size.width > 0) return size;
  return Problem{fmt::format("{} and {} have no {}picture size in common", request.device,
                             second.path, request.depth.empty() ? "" : "depth and ")};
}

// The size of one eye: the requested one, or the calibration's, or the camera's default.
Result<EyeSize> eye_size(const CameraRequest& request, const CameraChoice& choice) {
  const bool one_eye_wide = choice.second.has_value() || is_interleaved(request, choice.first);
  const EyeSize asked{one_eye_wide ? request.width : request.width / 2, request.height};
  if (asked.width > 0) return asked;
  if (!request.calibration.empty() && request.calibration.extension() != ".conf") {
    const Result<SourceCalibration> calibration = read_source_calibration(
        request.calibration, 0, 0,
        request.depth.empty() ? FrameFormat::Kind::kStereo : FrameFormat::Kind::kColorDepth);
    if (!calibration.ok()) return calibration.problem();
    const FrameFormat& format = calibration.value().format;
    if (format.width > 0 && !calibration.value().has_more_sizes)
      return EyeSize{format.width, format.height};
  }
  if (choice.second) return common_size(request, choice.first, *choice.second);
  const std::optional<EyeSize> size = size_of_two_eyes(choice.first);
  if (size) return *size;
  return Problem{fmt::format(
      "{} ({}) gives one eye's pictures only: name the other eye's camera with --right, or the "
      "depth of the same view with --depth-source",
      request.device, choice.first.name)};
}

CameraSettings settings_of_first(const CameraRequest& request, const CameraChoice& choice) {
  CameraSettings settings;
  settings.interleaved = is_interleaved(request, choice.first);
  const bool side_by_side = !choice.second && !settings.interleaved;
  settings.width = side_by_side ? 2 * choice.eye.width : choice.eye.width;
  settings.height = choice.eye.height;
  settings.frames_per_second = request.frames_per_second;
  settings.exposure_ms = request.exposure_ms;
  settings.gain = request.gain;
  return settings;
}

// Exposure and gain apply to the colour camera; a depth device does not share these controls.
CameraSettings settings_of_second(const CameraRequest& request, const CameraSettings& first) {
  CameraSettings settings = first;
  const CameraSettings use = use_of_second(request);
  settings.depth = use.depth;
  settings.y16_is_depth = use.y16_is_depth;
  if (settings.depth) settings.exposure_ms = settings.gain = std::nullopt;
  return settings;
}

}  // namespace

EyeSize comfortable_size(const CameraInfo& info, const CameraSettings& use,
                         const UsedCamera* also) {
  EyeSize best;
  for (const CameraMode& mode : info.modes) {
    if (!serves(mode.format, use) || (also != nullptr && !offers(*also, mode))) continue;
    const bool fits = mode.height <= kPreferredHeight;
    const bool best_fits = best.height <= kPreferredHeight;
    const bool larger = mode.width * mode.height > best.width * best.height;
    if (best.width == 0 || (fits && !best_fits) || (fits == best_fits && fits == larger)) {
      best = {mode.width, mode.height};
    }
  }
  return best;
}

bool is_side_by_side(const CameraMode& mode) {
  constexpr int kWidest = 7;  // times as wide as high; both eyes of KITTI have 6.6
  return is_color_format(mode.format) && looks_side_by_side(mode.width, mode.height) &&
         mode.width <= kWidest * mode.height;
}

const CameraMode* side_by_side_mode(const CameraInfo& info) {
  const CameraMode* best = nullptr;
  for (const CameraMode& mode : info.modes) {
    if (!is_side_by_side(mode)) continue;
    if (mode.width == kPreferredWidth && mode.height == kPreferredHeight) return &mode;
    const bool fits = mode.width <= kPreferredWidth;
    const bool best_fits = best != nullptr && best->width <= kPreferredWidth;
    const bool larger = best != nullptr && mode.width > best->width;
    if (best == nullptr || (fits && !best_fits) || (fits == best_fits && fits == larger)) {
      best = &mode;
    }
  }
  return best;
}

std::optional<EyeSize> size_of_two_eyes(const CameraInfo& info) {
  if (const CameraMode* mode = side_by_side_mode(info)) {
    return EyeSize{mode->width / 2, mode->height};
  }
  CameraSettings use;
  use.interleaved = true;
  // Y12I is not rectified (v4l2_camera.cpp), so that its sizes are taken only if there is no Y8I.
  CameraInfo rectified = info;
  std::erase_if(rectified.modes,
                [](const CameraMode& mode) { return mode.format != four_letters("Y8I "); });
  const EyeSize size = comfortable_size(rectified.modes.empty() ? info : rectified, use, nullptr);
  if (size.width == 0) return std::nullopt;
  return size;
}

std::optional<CameraInfo> other_device_of(const CameraInfo& camera, const CameraSettings& use,
                                          VideoSystem& system) {
  if (camera.bus.empty()) return std::nullopt;
  for (const std::string& path : system.devices()) {
    if (is_same_device(path, camera.path)) continue;
    Result<CameraInfo> info = query_camera(system, path);
    if (info.ok() && info.value().bus == camera.bus && any_serves(info.value(), use)) {
      return std::move(info).value();
    }
  }
  return std::nullopt;
}

Result<CameraChoice> choose_camera(const CameraRequest& request, VideoSystem& system) {
  CameraChoice choice;
  for (const std::string& other : {request.right, request.depth}) {
    if (other.empty() || !is_same_device(other, request.device)) continue;
    return Problem{
        fmt::format("{} is named twice: a device gives one kind of pictures at a time, so that {} "
                    "needs another one; palpable cameras lists them",
                    request.device, request.depth.empty() ? "--right" : "--depth-source")};
  }
  Result<CameraInfo> first = query_camera(system, request.device);
  if (!first.ok()) return first.problem();
  choice.first = std::move(first).value();
  if (auto problem = no_pictures(request, choice.first, system)) return *problem;
  if (request.depth.empty() && request.depth_unit) {
    return Problem{
        "--depth-unit is of a depth camera: name it with --depth-source, or leave the unit out"};
  }
  if (!request.depth.empty() || !request.right.empty()) {
    Result<CameraInfo> second = request.depth.empty()
                                    ? query_camera(system, request.right)
                                    : find_depth(request, choice.first, system, choice.notes);
    if (!second.ok()) return second.problem();
    choice.second = std::move(second).value();
  }
  const Result<EyeSize> eye = eye_size(request, choice);
  if (!eye.ok()) return eye.problem();
  choice.eye = eye.value();
  choice.first_settings = settings_of_first(request, choice);
  choice.second_settings = settings_of_second(request, choice.first_settings);
  // A camera for USB 3 that could do more is used at a size that USB 2 allows.
  const bool own_size = request.width == 0 && request.calibration.empty();
  if (own_size && choice.eye.height < kPreferredHeight) {
    const std::string hint = usb_hint(choice.first.usb);
    if (!hint.empty()) {
      choice.notes.push_back(fmt::format("{} gives {}x{} px{}", request.device,
                                         choice.first_settings.width, choice.first_settings.height,
                                         hint));
    }
  }
  return choice;
}

}  // namespace palpable
