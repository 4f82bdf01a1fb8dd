/// @file
/// The chessboards that a stereo source shows, for a calibration.
#pragma once

#include "palpable/live/calibrate/board_calibration.h"
#include "palpable/live/sources/frame_source.h"

#include <functional>
#include <string>
#include <vector>

namespace palpable {

struct SeenBoards {
  std::vector<BoardView> views;  ///< different enough from each other
  int pairs = 0;                 ///< stereo pairs that were searched
  int alike = 0;                 ///< boards left out: they stood nearly where another one had
};

/// After each attempt to read a frame.
struct BoardSearchStep {
  const SeenBoards& seen;
  bool searched = false;             ///< a pair was read and searched
  bool is_live = false;              ///< the source is a camera: it ends when enough were seen
  int done = 0;                      ///< boards of a camera, pairs of a recording
  int total = 0;                     ///< what `done` will be at the end
  std::vector<std::string> reports;  ///< of the source since the step before, a line each
};

/// Searches a source until it ends or, a camera, until `wanted` boards were seen. A board that
/// moved by less than 2 % of the picture's width since another one teaches a calibration next to
/// nothing and is left out.
[[nodiscard]] SeenBoards find_boards(FrameSource& source, const BoardPattern& pattern, int wanted,
                                     const std::function<void(const BoardSearchStep&)>& on_step);

}  // namespace palpable
