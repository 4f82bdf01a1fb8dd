/// @file
/// A camera that measures depth itself (time of flight, structured light) beside a colour image.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/base/stage_clock.h"
#include "palpable/common/geometry/frame.h"
#include "palpable/live/depth/depth_noise.h"
#include "palpable/live/depth/depth_registration.h"
#include "palpable/live/depth/depth_settings.h"
#include "palpable/live/depth/seen_frame.h"

#include <optional>

namespace palpable {

/// One of DepthCamera's three cameras. Depth passes through in the colour camera's view; what is
/// not a depth, or lies beyond settings.farthest, becomes NaN.
class DepthSensorCamera {
 public:
  /// A problem when a focal length is not positive or the colour's numbers fit no camera.
  [[nodiscard]] static Result<DepthSensorCamera> make(const FrameFormat& format,
                                                      const DepthSettings& settings);

  /// Fills what DepthCamera::see() leaves open of `seen`.
  /// @param seen  its color and depth have their sizes already
  /// @return false, and `seen` unspecified, when the frame's images do not have the format's size
  bool measure(const Frame& frame, SeenFrame& seen, StageTimes& times);

  [[nodiscard]] const PinholeCamera& camera() const { return camera_; }
  [[nodiscard]] const PinholeCamera& depth_camera() const { return camera_; }
  [[nodiscard]] const DepthNoise& noise() const { return noise_; }
  [[nodiscard]] bool has_two_sensors() const { return registration_.has_value(); }

 private:
  DepthSensorCamera() = default;

  int width_ = 0;   // px, of a frame's images
  int height_ = 0;  // px
  double farthest_ = 0;
  PinholeCamera camera_;
  DepthNoise noise_ = time_of_flight_noise();
  std::optional<DepthRegistration> registration_;  // where the colour is another view
  DepthImage own_view_;                            // of the depth sensor, before it is registered
};

}  // namespace palpable
