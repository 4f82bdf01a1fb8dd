/// @file
/// How depth is measured.
#pragma once

#include <optional>

namespace palpable {

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
  /// Depths beyond are unknown, m. Nothing: 20 m, and for a stereo rig as far as the disparity is
  /// 12 px of the full images if that is farther: 20 m for a rig of 63 mm at 720p (half a pixel is
  /// 25 % of the depth there), and 32 m for a car's of 537 mm. A rig's rows are off by 0.1 px where
  /// its calibration is good: 1 % of the depth at 12 px, and of the path of a camera that goes by
  /// it.
  std::optional<double> farthest = std::nullopt;
  /// Match stereo at full resolution instead of half: for scenes, small images and benchmarks.
  /// Takes about 6 times as long.
  bool full_resolution = false;
  /// The same for images at most so wide, px, whatever full_resolution says: at half of their size
  /// there would be too little left to match.
  int full_up_to_px = 0;
  /// A patch of connected pixels smaller than this is noise and becomes unknown (kOpenCv).
  int speckle_size_px = 60;
  int threads = 2;  ///< of kCensus; the depth does not depend on it
  /// Measure the row error of every frame, and correct it once it lasts (row_watch.h; kCensus).
  bool watch_rows = true;
};

inline constexpr double kUsualFarthest = 20.0;      ///< m
inline constexpr double kLeastUsualDisparity = 12;  ///< px of the full images, of farther depths

}  // namespace palpable
