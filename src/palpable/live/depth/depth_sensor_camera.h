/// @file
/// A camera with a depth sensor (time of flight, structured light) beside the colour sensor.
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

/// One of DepthCamera's three cameras. Its depth is the sensor's depth in the colour camera's view;
/// values that are no depths, or beyond settings.farthest, become NaN, and so do flying pixels
/// (flying_pixels.h).
class DepthSensorCamera {
 public:
  /// Returns a problem if a camera or the pose between them is not valid (calibration_check.h).
  [[nodiscard]] static Result<DepthSensorCamera> make(const FrameFormat& format,
                                                      const DepthSettings& settings);

  /// Fills those parts of `seen` that DepthCamera::see() does not fill.
  /// @param seen  its color and depth have their sizes already
  /// @return false, and `seen` unspecified, if the frame's images do not have the format's size
  bool measure(const Frame& frame, SeenFrame& seen, StageTimes& times);

  [[nodiscard]] const PinholeCamera& camera() const { return camera_; }
  [[nodiscard]] const PinholeCamera& depth_camera() const { return camera_; }
  [[nodiscard]] const DepthNoise& noise() const { return noise_; }
  [[nodiscard]] bool has_two_sensors() const { return registration_.has_value(); }

 private:
  DepthSensorCamera() = default;
  void survey(const DepthImage& depth, MeasuredDepth& measured) const;

  int width_ = 0;         // px, of a frame's colour image
  int height_ = 0;        // px
  int depth_width_ = 0;   // px, of a frame's depth image
  int depth_height_ = 0;  // px
  double farthest_ = 0;
  float focal_px_ = 0;     // of the depth sensor
  double depth_unit_ = 0;  // m, FrameFormat::depth_unit
  PinholeCamera camera_;
  DepthNoise noise_ = time_of_flight_noise();
  std::optional<DepthRegistration> registration_;  // if colour and depth have different views
  DepthImage own_view_;                            // depth in the depth sensor's view
};

}  // namespace palpable
