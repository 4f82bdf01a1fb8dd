/// @file
/// Depth of a stereo rig by OpenCV's semi-global block matcher: the reference with which ours is
/// compared in `palpable bench depth`.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/base/stage_clock.h"
#include "palpable/live/depth/stereo_eyes.h"

#include <memory>

namespace palpable {

/// One of DepthCamera's three cameras. It provides neither the mask of too close pixels nor
/// confidences, and does not measure row errors.
class SgbmCamera {
 public:
  /// Returns a problem if the rig is not valid (StereoEyes) or OpenCV has no matcher for it.
  [[nodiscard]] static Result<SgbmCamera> make(const FrameFormat& format,
                                               const DepthSettings& settings);
  SgbmCamera(SgbmCamera&&) noexcept;
  SgbmCamera& operator=(SgbmCamera&&) noexcept;
  ~SgbmCamera();

  /// Fills those parts of `seen` that DepthCamera::see() does not fill.
  /// @param seen  its color and depth have their sizes already
  /// @return false, and `seen` unspecified, if the frame's images do not have the format's size
  bool measure(const Frame& frame, SeenFrame& seen, StageTimes& times);

  [[nodiscard]] const PinholeCamera& camera() const;
  [[nodiscard]] const PinholeCamera& depth_camera() const;
  [[nodiscard]] const RectifiedStereo& rectified() const;
  [[nodiscard]] const DepthNoise& noise() const;

 private:
  struct Parts;
  explicit SgbmCamera(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable
