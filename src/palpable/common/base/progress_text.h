/// @file
/// Formats a progress report (progress.h) as one line of text.
#pragma once

#include "palpable/common/base/progress.h"

#include <string>

namespace palpable {

/// "12 s", "3 min 05 s", "2 h 10 min". @param seconds >= 0
[[nodiscard]] std::string duration_text(double seconds);

/// The line for one report, without line end: task, bar or per cent, time left, note.
/// @param bar_width  0: no bar   @param elapsed  seconds since the task began
/// @param begun      fraction that was already done when the task began, 0 .. 1: more than 0 for
/// work
///                   that continues an interrupted run
[[nodiscard]] std::string progress_line(const ProgressReport& report, double elapsed, int bar_width,
                                        double begun = 0);

}  // namespace palpable
