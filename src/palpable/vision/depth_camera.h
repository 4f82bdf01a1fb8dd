/// @file
/// From a camera's frame to depth in metres (paper Sec. 3.3): undistort, rectify, find
/// correspondences, Z = f T / d.
#pragma once

#include "palpable/base/error.h"
#include "palpable/base/stage_clock.h"
#include "palpable/vision/depth_noise.h"
#include "palpable/vision/frame.h"

#include <memory>

namespace palpable {

/// Depth and colour of one moment, both in the frame of the (rectified) left camera.
struct SeenFrame {
  int number = 0;
  double time = 0;  ///< s
  ColorImage color;
  PinholeCamera camera;  ///< of `color`
  DepthImage depth;      ///< Z in m, NaN unknown; half as large as `color` for stereo
  PinholeCamera depth_camera;
};

struct DepthSettings {
  /// Disparities are searched up to this depth in m. A range that is too short does not leave
  /// holes, it calls near things far, so it reaches nearer than anything that touches: 0.14 m is
  /// 157 px at half resolution of a 720p pair (f = 700 px, T = 63 mm).
  double nearest = 0.14;
  /// Depths beyond are unknown, m. At 720p half a pixel of disparity is 25 % of the depth at 20 m.
  double farthest = 20.0;
  /// Stereo at full resolution instead of half: for small images and benchmarks; about 6 times the
  /// time.
  bool full_resolution = false;
  /// A patch of connected pixels smaller than this is noise and becomes unknown.
  int speckle_size_px = 60;
};

/// Turns frames of one format into depth. Takes memory while it is made and at the first frame;
/// then its own code takes none (what OpenCV takes inside for each frame, it gives back).
class DepthCamera {
 public:
  /// A problem when a stereo format's numbers do not make a rig, or the format's size is too small
  /// for its disparities.
  [[nodiscard]] static Result<DepthCamera> make(const FrameFormat& format,
                                                const DepthSettings& settings = {});
  DepthCamera(DepthCamera&&) noexcept;
  DepthCamera& operator=(DepthCamera&&) noexcept;
  ~DepthCamera();

  /// Fills `seen`, whose memory is used again. A frame whose images have not the format's size
  /// gives an image without depth (all NaN) rather than an error: the loop goes on.
  void see(const Frame& frame, SeenFrame& seen);

  /// Of `color` and of `depth` in every SeenFrame.
  [[nodiscard]] const PinholeCamera& camera() const;
  [[nodiscard]] const PinholeCamera& depth_camera() const;
  /// How far its depths scatter, for whoever compares two of them.
  [[nodiscard]] const DepthNoise& noise() const;
  /// Wall time of the last frame: "rectify" (luma and colour), "disparity", "depth" (filters, Z).
  [[nodiscard]] const StageTimes& last_times() const;

 private:
  struct Parts;
  explicit DepthCamera(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable
