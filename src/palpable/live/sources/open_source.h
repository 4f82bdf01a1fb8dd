/// @file
/// Opens a camera, a folder, images, a video or a recording by the name that a user gives.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/camera_source.h"
#include "palpable/live/sources/frame_source.h"

#include <memory>
#include <string>

namespace palpable {

/// Like open_camera(), but `device` may also be a folder, images by name (cam0/*.png), one image,
/// or a video file; `right` and `depth` then name the other images or the other file. It may also
/// be a recording (*.palprec), which needs no other argument. Size, rate, exposure and gain apply
/// to cameras only.
///
/// A folder is opened by open_folder(), a name with * or ? or of an image by open_patterns() (both
/// folder_source.h), a video by video_file_source.h, a recording by recording_file.h, and a path in
/// /dev by camera_source.h.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_source(const CameraRequest& request,
                                                               VideoSystem& system = linux_video());

}  // namespace palpable
