/// @file
/// What is plugged in, and what it can do.
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/live/sources/v4l2_camera.h"
#include "palpable/live/sources/video_system.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

/// What the pictures of a device are taken to be.
enum class CameraKind { kUnreadable, kSideBySide, kDepth, kOneEye };

struct ListedCamera {
  CameraInfo info;      ///< only its path where there is trouble
  std::string trouble;  ///< why it could not be asked; empty: it was
  CameraKind kind = CameraKind::kUnreadable;
  /// Of two eyes: the file that open_camera() would take for the mode that it would choose; empty:
  /// none is known.
  std::filesystem::path calibration;
};

/// Every device that may be a camera.
/// @param folders  where calibrations are kept
[[nodiscard]] std::vector<ListedCamera> list_cameras(
    VideoSystem& system, const std::vector<std::filesystem::path>& folders);

/// Lines for people: sizes, formats and rates, what the pictures look like, whether exposure and
/// gain can be fixed; or the trouble.
[[nodiscard]] std::string text_of(const ListedCamera& camera);

/// {"cameras": [...]}, the same for programs.
[[nodiscard]] Json json_of(const std::vector<ListedCamera>& cameras);

}  // namespace palpable
