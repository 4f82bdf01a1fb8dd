/// @file
/// From a camera's frame to depth in metres (paper Sec. 3.3): undistort, rectify, find
/// correspondences, Z = f T / d.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/base/stage_clock.h"
#include "palpable/common/geometry/frame.h"
#include "palpable/live/depth/depth_noise.h"
#include "palpable/live/depth/depth_settings.h"
#include "palpable/live/depth/seen_frame.h"

#include <memory>

namespace palpable {

/// Turns the frames of one source into depth, by one of three cameras:
///
///     format                     settings.matcher   camera
///     colour + depth             -                  DepthSensorCamera (depth_sensor_camera.h)
///     stereo, raw or rectified   kCensus            CensusCamera (census_camera.h)
///     stereo, raw or rectified   kOpenCv            SgbmCamera (sgbm_camera.h)
///
/// Allocates memory during construction and at the first frame; afterwards its own code does not
/// (OpenCV allocates temporary memory in each frame).
class DepthCamera {
 public:
  /// Returns a problem if the numbers of a stereo format are not a valid rig, or if the images are
  /// too small for stereo.
  [[nodiscard]] static Result<DepthCamera> make(const FrameFormat& format,
                                                const DepthSettings& settings = {});
  DepthCamera(DepthCamera&&) noexcept;
  DepthCamera& operator=(DepthCamera&&) noexcept;
  ~DepthCamera();

  /// Fills `seen`, whose memory is reused. A frame whose images do not have the format's size gives
  /// an image without depth (all NaN) rather than an error, so that the loop continues.
  void see(const Frame& frame, SeenFrame& seen);

  /// The cameras of `color` and of `depth` in every SeenFrame.
  [[nodiscard]] const PinholeCamera& camera() const;
  [[nodiscard]] const PinholeCamera& depth_camera() const;
  /// The rectified rig of a stereo format, at the size of `color`; null for colour + depth.
  [[nodiscard]] const RectifiedStereo* rectified() const;
  /// The standard deviation of measured depths.
  [[nodiscard]] const DepthNoise& noise() const;
  /// Whether colour and depth come from two separate sensors, each with a lens of its own.
  [[nodiscard]] bool has_two_sensors() const;
  /// Wall time of the last frame: "rectify" (luma and colour), "disparity", "depth" (filters, Z).
  [[nodiscard]] const StageTimes& last_times() const;

 private:
  struct Parts;
  explicit DepthCamera(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable
