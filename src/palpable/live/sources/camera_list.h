/// @file
/// The connected cameras and their capabilities.
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/live/sources/v4l2_camera.h"
#include "palpable/live/sources/video_system.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

/// Kind of a device, judged by its formats and picture sizes.
enum class CameraKind {
  kUnreadable,
  kSideBySide,
  kInterleaved,  ///< both eyes' pixels in turn (is_interleaved_format())
  kDepth,
  kOneEye,
  kGray16  ///< only Y16, which may be depth (is_gray16_format())
};

struct ListedCamera {
  CameraInfo info;       ///< only the path if there is a problem
  std::string trouble;   ///< why the device could not be queried; empty: no problem
  bool is_data = false;  ///< it is there for data about pictures, which is no fault
  std::string users;     ///< other programs that have opened it (VideoSystem::users())
  /// Of a depth device (kDepth): the colour device of the same camera with the same view; empty if
  /// there is none.
  std::string pictures;
  CameraKind kind = CameraKind::kUnreadable;
  /// Both eyes: the calibration file that open_camera() would use for its default mode;
  /// empty: none is known.
  std::filesystem::path calibration;
};

/// All devices that may be cameras.
/// @param folders  that may contain calibrations
[[nodiscard]] std::vector<ListedCamera> list_cameras(
    VideoSystem& system, const std::vector<std::filesystem::path>& folders);

/// Readable lines: sizes, formats and rates, kind of pictures, whether exposure and gain can be
/// fixed, and what may disturb: a USB 2 port, another program, an exposure that may lower the rate;
/// or the problem.
[[nodiscard]] std::string text_of(const ListedCamera& camera);

/// {"cameras": [...]}: the same as JSON.
[[nodiscard]] Json json_of(const std::vector<ListedCamera>& cameras);

}  // namespace palpable
