/// @file
/// Converts the depth camera's calibration and frames into the tracker's settings and frames.
#pragma once

#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/track/tracker.h"

namespace palpable {

/// Settings for the frames that `camera` delivers. For a colour + depth camera the baseline is
/// kDepthCameraBaseline.
[[nodiscard]] TrackerSettings tracker_settings(const DepthCamera& camera);

/// The frame for Tracker::track(). It points into `seen`, which must outlive that call.
/// @param moving  255 where something moves, of the depth's size; or null
[[nodiscard]] TrackerFrame tracker_frame(const SeenFrame& seen, const MaskImage* moving = nullptr);

}  // namespace palpable
