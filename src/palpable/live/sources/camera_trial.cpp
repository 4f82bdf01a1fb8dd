#include "palpable/live/sources/camera_trial.h"

#include "palpable/live/sources/camera_choice.h"
#include "palpable/live/sources/raw_picture.h"
#include "palpable/live/sources/v4l2_camera.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

namespace palpable {
namespace {

// The settings for the camera's own default size.
CameraSettings trial_settings(const ListedCamera& camera) {
  CameraSettings settings;
  settings.interleaved = camera.kind == CameraKind::kInterleaved;
  settings.depth = camera.kind == CameraKind::kDepth || camera.kind == CameraKind::kGray16;
  settings.y16_is_depth = camera.kind == CameraKind::kGray16;
  const bool side_by_side = camera.kind == CameraKind::kSideBySide;
  const std::optional<EyeSize> both = size_of_two_eyes(camera.info);
  const EyeSize eye = both && (side_by_side || settings.interleaved)
                          ? *both
                          : comfortable_size(camera.info, settings, nullptr);
  settings.width = side_by_side ? 2 * eye.width : eye.width;
  settings.height = eye.height;
  return settings;
}

// Why the bytes are no picture; empty if they are one.
std::string picture_trouble(const RawPicture& raw) {
  ColorImage left, right;
  DepthImage depth;
  if (is_interleaved_format(raw.format)) return to_eyes(raw, left, right);
  if (is_color_format(raw.format)) return to_color(raw, left);
  return to_depth(raw, 1, depth);
}

void count(V4l2Camera& camera, V4l2Camera::Grab grab, CameraTrial& trial) {
  const std::string trouble =
      grab == V4l2Camera::Grab::kBroken ? camera.trouble() : picture_trouble(camera.picture());
  if (trouble.empty()) {
    ++trial.pictures;
    return;
  }
  ++trial.unusable;
  trial.last_unusable = trouble;
}

}  // namespace

CameraTrial try_camera(VideoSystem& system, const ListedCamera& camera, double seconds) {
  CameraTrial trial;
  const CameraSettings settings = trial_settings(camera);
  trial.width = settings.width;
  trial.height = settings.height;
  Result<V4l2Camera> opened = V4l2Camera::open(system, camera.info.path, settings);
  if (!opened.ok()) {
    trial.trouble = opened.problem().message;
    return trial;
  }
  V4l2Camera& device = opened.value();
  trial.format = letters_of(device.picture().format);
  const double end = system.now() + seconds;
  while (system.now() < end) {
    const V4l2Camera::Grab grab = device.grab(std::max(0.0, end - system.now()));
    if (grab == V4l2Camera::Grab::kNothing) continue;
    if (grab == V4l2Camera::Grab::kGone) {
      trial.trouble = device.trouble();
      return trial;
    }
    count(device, grab, trial);
  }
  trial.notes = device.take_notes();
  if (trial.pictures + trial.unusable == 0) {
    trial.trouble = fmt::format(
        "{} has started but sent no picture in {:g} s: unplug it, and plug it into another port, "
        "without a hub",
        camera.info.path, seconds);
  }
  return trial;
}

std::string what_is_wrong_with(const CameraTrial& trial) {
  if (!trial.trouble.empty()) return trial.trouble;
  if (!trial.notes.empty()) return trial.notes.back();
  // The first pictures of many cameras are incomplete, which a run leaves out.
  constexpr int kUsualAtStart = 3;
  if (trial.unusable <= kUsualAtStart && trial.pictures > 0) return {};
  return fmt::format(
      "{} of {} pictures cannot be used, the last because {}: another cable or USB port, without a "
      "hub, or a lower --size or --fps",
      trial.unusable, trial.unusable + trial.pictures, trial.last_unusable);
}

}  // namespace palpable
