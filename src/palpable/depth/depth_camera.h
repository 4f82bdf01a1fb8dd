/// @file
/// From a camera's frame to depth in metres (paper Sec. 3.3): undistort, rectify, find
/// correspondences, Z = f T / d.
#pragma once

#include "palpable/base/error.h"
#include "palpable/base/stage_clock.h"
#include "palpable/depth/depth_noise.h"
#include "palpable/depth/pair_fit.h"
#include "palpable/geometry/frame.h"

#include <limits>
#include <memory>
#include <optional>

namespace palpable {

/// Depth and colour of one moment, both in the frame of the (rectified) left or of the colour
/// camera: a depth sensor that stands elsewhere is registered to it (depth_registration.h).
struct SeenFrame {
  int number = 0;
  double time = 0;  ///< s
  ColorImage color;
  PinholeCamera camera;  ///< of `color`
  GrayImage left;        ///< luma of `color`
  GrayImage left_half;   ///< the same at half the size; empty where stereo was not matched at that
  GrayImage right;       ///< luma of the right eye, rectified, as large; empty without a right eye
  DepthImage depth;      ///< Z in m, NaN unknown; half as large as `color` for stereo
  PinholeCamera depth_camera;
  /// 255 where something is nearer than the searched range (its depth is unknown); of the depth's
  /// size. Empty when nothing watches for that: time of flight, OpenCV's matcher.
  MaskImage too_close;
  /// How well a depth is known (disparity_filters.h), 0 where it is not; of the depth's size. Empty
  /// when the camera or OpenCV's matcher does not say.
  GrayImage confidence;
  /// Median row error of matched points in this frame, px of the full images, positive where the
  /// right image lies lower; NaN when too few points say so or nothing watches.
  double row_error_px = std::numeric_limits<double>::quiet_NaN();
  /// By how much the right image's middle was moved up in this frame beyond the calibration, px.
  double row_correction_px = 0;
  /// Set on the first frame when its images do not fit the calibration (pair_fit.h), with
  /// `rows_px` of the full images: what follows would be worthless.
  std::optional<PairMisfit> misfit;
};

struct DepthSettings {
  enum class Matcher {
    kCensus,  ///< stereo_matcher.h
    kOpenCv   ///< cv::StereoSGBM, 3-way: the reference
  };
  Matcher matcher = Matcher::kCensus;
  /// Disparities are searched up to this depth in m: 184 px at half resolution of a 720p pair
  /// (f = 700 px, T = 63 mm). A range that is too short does not leave holes, it calls near things
  /// far; kCensus guards against that, kOpenCv does not.
  double nearest = 0.12;
  /// Depths beyond are unknown, m. At 720p half a pixel of disparity is 25 % of the depth at 20 m.
  double farthest = 20.0;
  /// Stereo matched at full resolution instead of half: for scenes, small images and benchmarks;
  /// about 6 times the time.
  bool full_resolution = false;
  /// A patch of connected pixels smaller than this is noise and becomes unknown (kOpenCv).
  int speckle_size_px = 60;
  int threads = 2;  ///< of kCensus; the depth does not depend on it
  /// Measure the row error of every frame, and correct it once it lasts (row_watch.h; kCensus).
  bool watch_rows = true;
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
  /// Of a stereo format: the rig, rectified, at the size of `color`. Unspecified without one.
  [[nodiscard]] const RectifiedStereo& rectified() const;
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
