/// @file
/// How depth is measured.
#pragma once

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
  /// Depths beyond are unknown, m. At 720p half a pixel of disparity is 25 % of the depth at 20 m.
  double farthest = 20.0;
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

}  // namespace palpable
