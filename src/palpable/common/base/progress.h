/// @file
/// How a long task reports its progress. The library never prints; programs draw the bar.
#pragma once

#include <functional>
#include <string>

namespace palpable {

/// One report of a long task.
struct ProgressReport {
  std::string task;  ///< e.g. "solving sites"; a new text starts a new bar
  double done = 0;   ///< in the task's own unit, 0 .. total
  double total = 1;  ///< > 0
  std::string note;  ///< e.g. "2 stopped early", "64 modes, error 1.2e-3"; may be empty
};

/// Called from the thread that does the work, a few times a second at most; never concurrently.
/// An empty function is allowed; then nothing is reported.
using Progress = std::function<void(const ProgressReport&)>;

/// Calls `progress` unless it is empty.
inline void report(const Progress& progress, const ProgressReport& report) {
  if (progress) progress(report);
}

/// "12 s", "3 min 05 s", "2 h 10 min". @param seconds >= 0
[[nodiscard]] std::string duration_text(double seconds);

/// The line for one report, without line end: task, bar or per cent, time left, note.
/// @param bar_width  0: no bar   @param elapsed  seconds since the task began
/// @param begun      fraction that was already done when the task began, 0 .. 1: more than 0 for
///                   work that continues an interrupted run
[[nodiscard]] std::string progress_line(const ProgressReport& report, double elapsed, int bar_width,
                                        double begun = 0);

}  // namespace palpable
