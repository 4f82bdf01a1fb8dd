/// @file
/// Options that describe a chessboard, shared by `calibrate` and `live --anchor board`.
#pragma once

#include "palpable/live/calibrate/board_calibration.h"

#include <string>

namespace palpable::app {

class Command;

struct BoardOptions {
  std::string corners = "9x6";
  double square_mm = 25;
};

/// Adds --board and --square.
void add_board_options(Command command, BoardOptions& options);

/// @throws Error when --board is invalid
[[nodiscard]] BoardPattern pattern_of(const BoardOptions& options);

}  // namespace palpable::app
