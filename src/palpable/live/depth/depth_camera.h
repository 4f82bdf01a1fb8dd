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
/// Allocates memory while it is made and at the first frame; then its own code allocates none (what
/// OpenCV allocates inside for a frame, it frees).
class DepthCamera {
 public:
  /// A problem when a stereo format's numbers do not make a rig, or the format's size is too small
  /// for its disparities.
  [[nodiscard]] static Result<DepthCamera> make(const FrameFormat& format,
                                                const DepthSettings& settings = {});
  DepthCamera(DepthCamera&&) noexcept;
  DepthCamera& operator=(DepthCamera&&) noexcept;
  ~DepthCamera();

  /// Fills `seen`, whose memory is used again. A frame whose images do not have the format's size
  /// gives an image without depth (all NaN) rather than an error: the loop goes on.
  void see(const Frame& frame, SeenFrame& seen);

  /// Of `color` and of `depth` in every SeenFrame.
  [[nodiscard]] const PinholeCamera& camera() const;
  [[nodiscard]] const PinholeCamera& depth_camera() const;
  /// The rig of a stereo format, rectified, at the size of `color`; null for colour + depth, which
  /// has none.
  [[nodiscard]] const RectifiedStereo* rectified() const;
  /// How far measured depths scatter around the true ones.
  [[nodiscard]] const DepthNoise& noise() const;
  /// Whether colour and depth come from two sensors that stand apart, each with a lens of its own.
  [[nodiscard]] bool has_two_sensors() const;
  /// Wall time of the last frame: "rectify" (luma and colour), "disparity", "depth" (filters, Z).
  [[nodiscard]] const StageTimes& last_times() const;

 private:
  struct Parts;
  explicit DepthCamera(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable
