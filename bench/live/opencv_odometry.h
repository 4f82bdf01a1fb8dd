/// @file
/// The camera's path by OpenCV's RGB-D odometry (Steinbrücker et al., ICCV Workshops 2011) and
/// nothing else: each frame against a keyframe, by brightness and depth, no map, no adjustment.
/// What our tracker has to be better than.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/live/depth/depth_camera.h"

#include <memory>

namespace palpable::app {

class OpenCvOdometry {
 public:
  /// @param camera    of the left, or colour, image
  /// @param farthest  m; pixels beyond do not count
  OpenCvOdometry(const PinholeCamera& camera, double farthest);
  OpenCvOdometry(OpenCvOdometry&&) noexcept;
  ~OpenCvOdometry();

  /// world_from_camera of the next frame; the world is the first one's camera. Where OpenCV finds
  /// no motion the camera goes on as before.
  Rigid3 follow(const SeenFrame& seen);
  [[nodiscard]] int failed() const;  ///< frames for which it found no motion

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable::app
