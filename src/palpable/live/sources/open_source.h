/// @file
/// Opens a camera, a folder, images or a video by the name that a user gives.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/camera_source.h"
#include "palpable/live/sources/frame_source.h"

#include <memory>
#include <string>

namespace palpable {

/// Like open_camera(), but `device` may also be a folder, images by name (cam0/*.png), one image,
/// or a video file; `right` and `depth` then name the other images or the other file. Or it is a
/// recording
/// (*.palprec), which needs nothing else. Size, rate, exposure and gain are for cameras only.
///
/// A folder is opened by folder_source.h, a name with * or ? or an image's by its open_patterns(),
/// a video's name by video_file_source.h, a recording's by recording_file.h, what lies in /dev by
/// camera_source.h.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_source(const CameraRequest& request,
                                                               VideoSystem& system = linux_video());

}  // namespace palpable
