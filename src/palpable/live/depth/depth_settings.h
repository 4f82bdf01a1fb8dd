/// @file
/// Settings of the depth measurement.
#pragma once

#include <optional>

namespace palpable {

/// The largest number of threads on which a pair is matched.
inline constexpr int kMostThreads = 16;

struct DepthSettings {
  enum class Matcher {
    kCensus,  ///< stereo_matcher.h
    kOpenCv   ///< cv::StereoSGBM, 3-way: the reference
  };
  Matcher matcher = Matcher::kCensus;
  /// Smallest depth that is searched, m: 0.12 m is a disparity of 184 px at half resolution of a
  /// 720p pair (f = 700 px, T = 63 mm). If a thing is closer, matching does not leave a hole but
  /// gives a wrong, large depth. kCensus guards against that, kOpenCv does not.
  double nearest = 0.12;
  /// Largest depth, m; depths beyond are unknown. Nothing: 20 m, or for a stereo rig the depth
  /// whose disparity is 12 px of the full images, if that is larger. That gives 20 m for a rig of
  /// 63 mm at 720p (where half a pixel is 25 % of the depth), and 32 m for a car's rig of 537 mm.
  /// Even a good calibration has an error of 0.1 px, which at 12 px is 1 % of the depth, and 1 % of
  /// the path length of a camera that is tracked by such depths.
  std::optional<double> farthest = std::nullopt;
  /// Match stereo at full resolution instead of half: for scenes, small images and benchmarks.
  /// Matching takes 3 to 4 times as long.
  bool full_resolution = false;
  /// Largest width of images, px, that are always matched at full resolution: at half their size
  /// there would be too little left to match.
  int full_up_to_px = 0;
  /// Connected patches of fewer pixels than this are noise and become unknown (kOpenCv).
  int speckle_size_px = 60;
  int threads = 2;  ///< of kCensus, kMostThreads at most; the depth does not depend on it
  /// Measure the row error of every frame, and correct it if it persists (row_watch.h; kCensus).
  bool watch_rows = true;
};

inline constexpr double kUsualFarthest = 20.0;      ///< m
inline constexpr double kLeastUsualDisparity = 12;  ///< px of the full images (farthest)

}  // namespace palpable
