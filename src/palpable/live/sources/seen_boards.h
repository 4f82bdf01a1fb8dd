/// @file
/// Searches a stereo source for chessboards, for a calibration.
#pragma once

#include "palpable/live/calibrate/board_calibration.h"
#include "palpable/live/sources/frame_source.h"

#include <functional>
#include <string>
#include <vector>

namespace palpable {

struct SeenBoards {
  std::vector<BoardView> views;  ///< sufficiently different from each other
  int pairs = 0;                 ///< stereo pairs that were searched
  int alike = 0;                 ///< skipped boards: nearly the pose of another one
};

/// Progress, reported after each attempt to read a frame.
struct BoardSearchStep {
  const SeenBoards& seen;
  bool searched = false;  ///< a pair was read and searched
  bool is_live = false;   ///< the source is a camera: the search ends when enough boards were found
  int done = 0;           ///< boards for a camera, pairs for a recording
  int total = 0;          ///< final value of `done`
  std::vector<std::string> reports;  ///< of the source since the previous step, one line each
};

/// Searches a source until it ends or, for a camera, until `wanted` boards were found. A board
/// that moved by less than 2 % of the picture's width from another one adds almost no
/// information and is skipped.
[[nodiscard]] SeenBoards find_boards(FrameSource& source, const BoardPattern& pattern, int wanted,
                                     const std::function<void(const BoardSearchStep&)>& on_step);

}  // namespace palpable
