#include "apps/palpable/camera_use.h"

#include <fmt/core.h>

namespace palpable::app {

std::string use_of(const ListedCamera& camera) {
  const std::string& path = camera.info.path;
  switch (camera.kind) {
    case CameraKind::kUnreadable:
      break;
    case CameraKind::kSideBySide:
      return fmt::format(
          "  calibration: {}\n  use: palpable live BODY --source {}\n",
          camera.calibration.empty()
              ? fmt::format("none known; palpable calibrate --source {} makes one", path)
              : camera.calibration.string(),
          path);
    case CameraKind::kDepth:
      return fmt::format(
          "  use: palpable live BODY --source DEVICE --depth {}, where DEVICE has the same view\n",
          path);
    case CameraKind::kOneEye:
      return fmt::format(
          "  use: palpable live BODY --source {} --right DEVICE, where DEVICE is the right eye\n",
          path);
  }
  return {};
}

}  // namespace palpable::app
