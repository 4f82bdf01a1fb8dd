/// @file
/// What the tracker is given, from what the depth camera says: the same for every program.
#pragma once

#include "palpable/depth/depth_camera.h"
#include "palpable/geometry/frame.h"
#include "palpable/track/tracker.h"

namespace palpable {

/// For frames of `format` that `camera` has seen. A colour + depth camera gets
/// kDepthCameraBaseline.
[[nodiscard]] TrackerSettings tracker_settings(const DepthCamera& camera,
                                               const FrameFormat& format);

/// Points into `seen`, which must outlive the call of track().
/// @param moving  255 where something moves, of the depth's size; or null
[[nodiscard]] TrackerFrame tracker_frame(const SeenFrame& seen, const MaskImage* moving = nullptr);

}  // namespace palpable
