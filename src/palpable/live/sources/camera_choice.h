/// @file
/// Which video devices a request means, and which of their pictures: their formats and sizes
/// decide, not the numbers of their nodes, which change from one start of the machine to the next.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/camera_info.h"
#include "palpable/live/sources/camera_source.h"
#include "palpable/live/sources/v4l2_camera.h"

#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct EyeSize {
  int width = 0;   ///< px
  int height = 0;  ///< px
};

struct CameraChoice {
  CameraInfo first;                  ///< both eyes, the left eye, or colour
  std::optional<CameraInfo> second;  ///< the right eye, or depth
  EyeSize eye;
  CameraSettings first_settings;
  CameraSettings second_settings;
  std::vector<std::string> notes;  ///< what the user should know, one line each
};

/// Queries the devices of a request and chooses sizes and formats: the requested size, or the
/// calibration's, or the camera's default.
///
/// A depth device that is "auto", or that has no depth, is replaced by the one of the same camera
/// that has: a RealSense has one device each for depth, infrared and colour, and others for data.
/// A problem names what is missing, and the device that has it.
[[nodiscard]] Result<CameraChoice> choose_camera(const CameraRequest& request, VideoSystem& system);

/// A device and the use of its pictures.
struct UsedCamera {
  const CameraInfo& info;
  const CameraSettings& use;
};

/// The largest size with a height up to 720 px among the modes that serve a use; if there is none,
/// the smallest; 0 x 0 if none serves.
/// @param also  has the size, too; may be null
[[nodiscard]] EyeSize comfortable_size(const CameraInfo& info, const CameraSettings& use,
                                       const UsedCamera* also);

/// The default mode with both eyes side by side: 2560 x 720 (a ZED's HD), else the largest that is
/// not wider; null if no mode has the aspect of two eyes.
[[nodiscard]] const CameraMode* side_by_side_mode(const CameraInfo& info);

/// Whether a mode has the aspect of two eyes and a format of colours. Strips of 848 x 100 px of one
/// eye, which a RealSense has, do not count.
[[nodiscard]] bool is_side_by_side(const CameraMode& mode);

/// The default size of one eye of a camera that sends both: side by side, or, if it has no such
/// mode, interleaved (is_interleaved_format()); empty if it sends one eye only.
[[nodiscard]] std::optional<EyeSize> size_of_two_eyes(const CameraInfo& info);

/// Another device of the same camera that serves a use; empty if there is none.
[[nodiscard]] std::optional<CameraInfo> other_device_of(const CameraInfo& camera,
                                                        const CameraSettings& use,
                                                        VideoSystem& system);

}  // namespace palpable
