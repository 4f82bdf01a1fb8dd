#include "palpable/live/sources/open_source.h"

#include "palpable/live/sources/folder_source.h"
#include "palpable/live/sources/recording_file.h"
#include "palpable/live/sources/video_file_source.h"

#include <fmt/core.h>

namespace palpable {

Result<std::unique_ptr<FrameSource>> open_source(const CameraRequest& request,
                                                 VideoSystem& system) {
  if (!request.right.empty() && !request.depth.empty()) {
    return Problem{"--right and --depth-source exclude each other: two eyes, or colour and depth"};
  }
  if (request.device.starts_with("/dev/")) return open_camera(request, system);
  if (request.depth == kDepthOfSameCamera) {
    return Problem{fmt::format(
        "--depth-source auto is for cameras only, and {} is none: name its depth images",
        request.device)};
  }
  if (request.width > 0 || request.frames_per_second > 0 || request.exposure_ms || request.gain ||
      request.lock) {
    return Problem{
        fmt::format("{} is a recording: size, rate, exposure and gain can be set of a camera only",
                    request.device)};
  }
  if (is_recording_name(request.device)) {
    if (request.without_calibration) {
      return Problem{fmt::format(
          "{} is a recording of palpable live, which was made with its camera's calibration: "
          "calibrate from the camera, or from a folder or a video of boards",
          request.device)};
    }
    if (request.depth_unit) {
      return Problem{
          fmt::format("--depth-unit is of depth images and depth cameras, and {} is a recording of "
                      "palpable live, whose depths are in metres",
                      request.device)};
    }
    if (request.right.empty() && request.depth.empty() && request.calibration.empty()) {
      return open_recording(request.device);
    }
    return Problem{fmt::format(
        "{} is a recording of palpable live, which has all images and its calibration: leave out "
        "--right, --depth-source and --calibration",
        request.device)};
  }
  const FolderSettings folder{request.calibration, request.without_calibration, request.baselines,
                              request.depth_unit};
  if (is_pattern(request.device) || is_image_name(request.device)) {
    const bool has_depth = !request.depth.empty();
    return open_patterns(request.device, has_depth ? request.depth : request.right, has_depth,
                         folder);
  }
  if (is_video_name(request.device)) {
    if (request.depth_unit) {
      return Problem{
          fmt::format("--depth-unit is of depth images, and {} is a video", request.device)};
    }
    if (!request.depth.empty()) {
      return Problem{fmt::format(
          "{} is a video, and --depth-source is for cameras and images by name", request.device)};
    }
    return open_video(request.device, request.right,
                      {request.calibration, request.without_calibration, request.baselines});
  }
  if (!request.right.empty() || !request.depth.empty()) {
    return Problem{
        fmt::format("{} is a folder, which has its own pairs; --right and --depth-source are "
                    "for cameras, videos, an image and images by name (*.png)",
                    request.device)};
  }
  return open_folder(request.device, folder);
}

}  // namespace palpable
