/// @file
/// What a video device can do (Linux V4L2, which includes UVC cameras).
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/video_system.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// Sizes between two, in steps; some drivers offer them instead of a list.
struct SizeSteps {
  int least_width = 0;   ///< px
  int least_height = 0;  ///< px
  int width_step = 1;    ///< px
  int height_step = 1;   ///< px
};

struct CameraMode {
  std::uint32_t format = 0;        ///< four letters
  int width = 0;                   ///< px, of the whole picture; the largest, if there are `steps`
  int height = 0;                  ///< px
  std::vector<double> rates;       ///< 1/s, the fastest first; empty: unknown
  bool has_rates_between = false;  ///< `rates` are the fastest and the slowest
  std::optional<SizeSteps> steps = {};
};

/// Whether a mode has a size, px.
[[nodiscard]] bool has_size(const CameraMode& mode, int width, int height);

struct CameraInfo {
  std::string path;     ///< /dev/video0
  std::string name;     ///< the maker's name for it, 31 letters at most
  std::string product;  ///< the same in full, if the system knows it; else empty
  std::string
      bus;  ///< the connector that it is plugged into; the same for all of a camera's devices
  UsbLink usb;
  std::vector<CameraMode> modes;  ///< those with a convertible format
  bool has_exposure = false;
  bool has_gain = false;
  /// Its automatic exposure may exceed the period in dim light, which lowers the rate
  /// (exposure_dynamic_framerate is on).
  bool may_slow_down = false;
};

/// Queries the capabilities of a device. A problem names the device and says that it does
/// not exist, is not a camera (but a metadata node or an encoder), or needs a permission
/// (the group `video`).
[[nodiscard]] Result<CameraInfo> query_camera(VideoSystem& system, const std::string& path);

/// Whether a device exists that is not for pictures: cameras have such a second one for data about
/// their pictures.
[[nodiscard]] bool is_data_device(VideoSystem& system, const std::string& path);

/// "; it is connected through USB 2 ...": to be appended to the message that a size is missing.
/// Empty unless the camera is one for USB 3 on a USB 2 port: there most of them only have small
/// sizes.
[[nodiscard]] std::string usb_hint(const UsbLink& usb);

}  // namespace palpable
