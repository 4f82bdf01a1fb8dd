/// @file
/// One budget of threads for a run, and who gets how many of them. No result depends on it.
#pragma once

namespace palpable {

/// Of the threads that a run may keep busy at a time, how many each part may use. Two threads take
/// turns anyhow: one sees the next frame while the other answers and draws this one. (Beside
/// them: one that writes files, one that adjusts keyframes now and then, and where that is wanted
/// one that records and one that answers between frames.)
struct ThreadShares {
  int matching = 1;  ///< of the stereo matcher (DepthSettings::threads)
  int images = 1;    ///< of OpenCV: warping and converting
  int drawing = 0;   ///< beside its own, of an OpenGL that draws in software; 0: none
};

/// @param threads  >= 1
[[nodiscard]] ThreadShares thread_shares(int threads);

/// As many as there are processors for this process.
[[nodiscard]] int usual_threads();

}  // namespace palpable
