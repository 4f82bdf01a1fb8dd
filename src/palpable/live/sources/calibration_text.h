/// @file
/// A calibration from boards, and how far it can be trusted, told to people and to other programs.
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/live/calibrate/board_calibration.h"
#include "palpable/live/sources/seen_boards.h"

#include <string>

namespace palpable {

/// Lines: the error of each view, lenses, baseline, and what is known of them.
/// @param seen  gave `found`
[[nodiscard]] std::string text_of(const BoardCalibration& found, const SeenBoards& seen,
                                  const BoardPattern& pattern);

/// The same, without the views. Lengths in m, the rest as its key says.
[[nodiscard]] Json json_of(const BoardCalibration& found, const SeenBoards& seen);

}  // namespace palpable
