#include "palpable/live/track/tracker_input.h"

namespace palpable {

TrackerSettings tracker_settings(const DepthCamera& camera) {
  TrackerSettings settings;
  settings.camera = {camera.camera(), kDepthCameraBaseline};
  settings.noise = camera.noise();
  settings.two_sensors = camera.has_two_sensors();
  if (const RectifiedStereo* rig = camera.rectified()) {
    settings.camera.baseline = rig->baseline;
    settings.disparity_at_infinity_px = rig->disparity_at_infinity_px;
  }
  return settings;
}

TrackerFrame tracker_frame(const SeenFrame& seen, const MaskImage* moving) {
  TrackerFrame frame;
  frame.number = seen.number;
  frame.time = seen.time;
  frame.left = &seen.left;
  frame.right = seen.right.empty() ? nullptr : &seen.right;
  frame.depth = &seen.depth;
  frame.moving = moving;
  return frame;
}

}  // namespace palpable
