#include "apps/palpable/board_options.h"

#include "apps/common/command_line.h"
#include "palpable/base/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <sstream>

namespace palpable::app {

void add_board_options(Command command, BoardOptions& options) {
  command.add_option("--board", options.corners, "Inner corners of the chessboard")
      .type_name("COLUMNSxROWS")
      .show_default();
  command.add_option("--square", options.square_mm, "Side of one of its squares, mm")
      .in_range(0.1, 10000.0)
      .show_default();
}

BoardPattern pattern_of(const BoardOptions& options) {
  BoardPattern pattern;
  std::istringstream text(options.corners);
  char times = 0;
  if (!(text >> pattern.columns >> times >> pattern.rows) || times != 'x' || !text.eof() ||
      std::min(pattern.columns, pattern.rows) < 3 ||
      std::max(pattern.columns, pattern.rows) > 100) {
    throw Error(
        fmt::format("--board {}: should be like 9x6, the board's inner corners", options.corners));
  }
  pattern.square = 1e-3 * options.square_mm;
  return pattern;
}

}  // namespace palpable::app
