/// @file
/// Cameras that are plugged in, as a source of frames: a stereo camera whose eyes come side by side
/// (UVC; a ZED Mini and others, without their makers' software), two cameras, or a colour and a
/// depth device that share one view.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/frame_source.h"
#include "palpable/live/sources/v4l2_camera.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct CameraRequest {
  std::string device;  ///< /dev/video0: both eyes side by side, or the left eye, or colour
  std::string right;   ///< the right eye's device; empty: side by side or depth
  /// A device with depth in Z16 or Y16, pixel for pixel the view of `device` (a RealSense's
  /// infrared picture is, its colour picture is not).
  std::string depth;
  std::filesystem::path calibration;  ///< empty: known_calibration() in `folders`
  std::vector<std::filesystem::path> folders;
  bool without_calibration = false;  ///< to take the pictures from which one is computed
  int width = 0;                     ///< px of the whole picture; 0: fitting the calibration
  int height = 0;                    ///< px
  double frames_per_second = 0;      ///< 0: as fast as it can
  std::optional<double> exposure_ms;
  std::optional<double> gain;
  /// After a second, switch automatic exposure, gain and white balance off and keep their values.
  bool lock = false;
};

/// Opens the devices and starts them. A problem names what is missing and what is there instead.
///
/// The source is live: it gives the newest pictures and waits at most kLongestWait for them. It is
/// kStalled after half a second without a picture; kGone when a device is unplugged, which is then
/// looked for every second. Frames have the driver's time stamps. The pictures of two devices are
/// one frame when their stamps are less than 0.6 periods apart. Both eyes side by side in YUYV are
/// handed over as they are (Frame::both), unless `without_calibration`: boards are looked for in
/// colours.
///
/// @param system  must outlive the source
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_camera(const CameraRequest& request,
                                                               VideoSystem& system = linux_video());

/// The file name under which a camera's calibration is kept: "zed-m-1280x720.yml" for "ZED-M" and
/// eyes of 1280 x 720 px.
[[nodiscard]] std::string calibration_name(const std::string& camera, int width, int height);

/// The first of the folders' files of that name; for a ZED also the one SN*.conf in a folder, if
/// there is exactly one.
[[nodiscard]] std::optional<std::filesystem::path> known_calibration(
    const std::string& camera, int width, int height,
    const std::vector<std::filesystem::path>& folders);

/// Where calibrations of cameras are kept: ~/.config/palpable (or XDG's), then where a ZED's own
/// software puts its files.
[[nodiscard]] std::vector<std::filesystem::path> calibration_folders();

/// The mode with both eyes side by side that is used by default: 2560 x 720 (a ZED's HD), else the
/// largest that is not wider; null when no mode looks like two eyes.
[[nodiscard]] const CameraMode* side_by_side_mode(const CameraInfo& info);

}  // namespace palpable
