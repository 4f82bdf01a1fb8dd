/// @file
/// What the files about V4L2 devices share: cleared structures, controls, and the meaning of
/// errors.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/camera_info.h"
#include "palpable/live/sources/video_system.h"

#include <cstdint>
#include <cstring>
#include <linux/videodev2.h>
#include <optional>
#include <string>

namespace palpable {

inline constexpr std::uint32_t kCapture = V4L2_BUF_TYPE_VIDEO_CAPTURE;
/// The control that v4l2-ctl calls exposure_dynamic_framerate.
inline constexpr std::uint32_t kDynamicRate = V4L2_CID_EXPOSURE_AUTO_PRIORITY;

template <class T>
[[nodiscard]] T zeroed() {
  T value;
  std::memset(&value, 0, sizeof value);
  return value;
}

/// What a system call's error on a camera means, and what to do: "another program is using it:
/// ...".
[[nodiscard]] std::string reason(VideoSystem& system, const std::string& path, int error);

/// The problem of a device that open() refused with this error.
[[nodiscard]] Problem cannot_open(VideoSystem& system, const std::string& path, int error);

/// query_camera() of a device that is open.
[[nodiscard]] Result<CameraInfo> query_open_device(VideoSystem& system, int device,
                                                   const std::string& path);

[[nodiscard]] bool has_control(VideoSystem& system, int device, std::uint32_t id);

/// 0, or the error number.
[[nodiscard]] int set_control(VideoSystem& system, int device, std::uint32_t id, int value);

/// Empty if the device has no such control.
[[nodiscard]] std::optional<int> value_of_control(VideoSystem& system, int device,
                                                  std::uint32_t id);

}  // namespace palpable
