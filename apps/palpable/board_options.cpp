#include "apps/palpable/board_options.h"

#include "apps/common/command_line.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

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
  const auto sides = parse_extent(options.corners).value_or(std::array{0, 0});
  if (*std::min_element(sides.begin(), sides.end()) < 3 ||
      *std::max_element(sides.begin(), sides.end()) > 100) {
    throw Error(
        fmt::format("--board {}: should be like 9x6, the board's inner corners", options.corners));
  }
  BoardPattern pattern;
  pattern.columns = sides[0];
  pattern.rows = sides[1];
  pattern.square = 1e-3 * options.square_mm;
  return pattern;
}

}  // namespace palpable::app
