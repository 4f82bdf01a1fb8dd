/// @file
/// Distribution of a run's threads among its parts. Does not change any result.
#pragma once

namespace palpable {

/// Numbers of threads for the parts of a run that compute in parallel. Two further threads always
/// exist, which work on alternate frames: one evaluates the next picture while the other responds
/// to and draws the present one. (Others are mostly idle: one writes files, one adjusts keyframes
/// from time to time, and on demand one records and one computes ticks between frames.)
struct ThreadShares {
  int matching = 1;  ///< for the stereo matcher (DepthSettings::threads)
  int images = 1;    ///< for OpenCV: warping and conversion
  int drawing = 0;   ///< additional threads of a software OpenGL; 0: none
};

/// @param threads  >= 1
[[nodiscard]] ThreadShares thread_shares(int threads);

/// The number of processors that this process may use.
[[nodiscard]] int usual_threads();

}  // namespace palpable
