/// @file
/// The camera's path by OpenCV's RGB-D odometry (Steinbrücker et al., ICCV Workshops 2011) alone:
/// each frame is aligned to a keyframe by brightness and depth, without a map or adjustment. A
/// baseline for our tracker.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/live/depth/depth_camera.h"

#include <memory>

namespace palpable::app {

class OpenCvOdometry {
 public:
  /// @param camera    of the left, or colour, image
  /// @param farthest  m; pixels with a larger depth are ignored
  OpenCvOdometry(const PinholeCamera& camera, double farthest);
  OpenCvOdometry(OpenCvOdometry&&) noexcept;
  ~OpenCvOdometry();

  /// world_from_camera of the next frame; the world is the camera of the first one. If OpenCV finds
  /// no motion, the last motion is repeated.
  Rigid3 follow(const SeenFrame& seen);
  [[nodiscard]] int failed() const;  ///< number of frames without a motion found

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable::app
