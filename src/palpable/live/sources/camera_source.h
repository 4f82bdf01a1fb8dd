/// @file
/// Connected cameras as a source of frames: a stereo camera that sends both eyes side by side
/// (UVC, e.g. a ZED Mini, without the maker's software) or interleaved (a RealSense's infrared),
/// two cameras, or a colour and a depth device with a common view.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/frame_source.h"
#include "palpable/live/sources/source_calibration.h"
#include "palpable/live/sources/v4l2_camera.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// CameraRequest::depth: the depth device of the camera that has the colours.
inline constexpr const char* kDepthOfSameCamera = "auto";

struct CameraRequest {
  std::string device;  ///< /dev/video0: both eyes in one picture, the left eye, or colour
  std::string right;   ///< device of the right eye; empty: side by side or depth
  /// Device with depth in Z16 whose pixels coincide with those of `device` (true for a RealSense's
  /// infrared picture, not for its colour picture). Y16 is taken as depth only if `depth_unit` or
  /// the calibration states what one step is. kDepthOfSameCamera, or a device of a camera without
  /// depth: the device of the same camera that has it (camera_choice.h).
  std::string depth;
  /// m per step of the depth camera's or depth image's numbers; empty: as the calibration, the
  /// layout of the folder or the table of known devices states, else 1 mm (depth_unit.h).
  std::optional<double> depth_unit;
  std::filesystem::path calibration;  ///< empty: known_calibration() in `folders`
  std::vector<std::filesystem::path> folders;
  BaselineRule baselines = BaselineRule::kUsual;
  bool without_calibration = false;  ///< for pictures from which a calibration will be computed
  int width = 0;                     ///< px, of the whole picture; 0: as the calibration
  int height = 0;                    ///< px
  double frames_per_second = 0;      ///< 0: the fastest
  std::optional<double> exposure_ms;
  std::optional<double> gain;
  /// Switches automatic exposure, gain and white balance off after one second and
  /// keeps their values.
  bool lock = false;
};

/// Opens the devices and starts them. A problem names what is missing and what is available
/// instead.
///
/// The source is live: it returns the newest pictures and waits for them at most kLongestWait. Its
/// state is kStalled after half a second without a picture, and kGone when a device was unplugged;
/// the device is then searched every second. Frames have the driver's time stamps, as far as they
/// are possible (picture_clock.h). Pictures of two devices form one frame if their stamps differ by
/// less than 0.6 periods. Pictures of both eyes in YUYV are passed on unconverted (Frame::both),
/// except with `without_calibration`, because the search for boards needs colours.
///
/// @param system  must outlive the source
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_camera(const CameraRequest& request,
                                                               VideoSystem& system = linux_video());

/// The file name of a camera's calibration, e.g. "zed-m-1280x720.yml" for "ZED-M" and eyes
/// of 1280 x 720 px.
[[nodiscard]] std::string calibration_name(const std::string& camera, int width, int height);

/// The first file of that name in the folders; for a ZED also the SN*.conf of a folder, if the
/// folder has exactly one.
[[nodiscard]] std::optional<std::filesystem::path> known_calibration(
    const std::string& camera, int width, int height,
    const std::vector<std::filesystem::path>& folders);

/// The folders of calibrations: ~/.config/palpable (or XDG's), then the folder of the
/// ZED's own software.
[[nodiscard]] std::vector<std::filesystem::path> calibration_folders();

}  // namespace palpable
