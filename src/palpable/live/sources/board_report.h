/// @file
/// A calibration from boards and its uncertainty, as text and as JSON.
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/live/calibrate/board_calibration.h"
#include "palpable/live/sources/seen_boards.h"

#include <string>

namespace palpable {

/// Readable lines: the error of each view, lenses, baseline, and their uncertainties.
/// @param seen  the boards from which `found` was computed
[[nodiscard]] std::string text_of(const BoardCalibration& found, const SeenBoards& seen,
                                  const BoardPattern& pattern);

/// The same without the views. Lengths in m, other units in the keys.
[[nodiscard]] Json json_of(const BoardCalibration& found, const SeenBoards& seen);

}  // namespace palpable
