/// @file
/// How long work tells its caller how far it is. The library never prints; programs draw the bar.
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
/// An empty function is allowed and means that nobody listens.
using Progress = std::function<void(const ProgressReport&)>;

/// Reports if somebody listens.
inline void report(const Progress& progress, const ProgressReport& report) {
  if (progress) progress(report);
}

}  // namespace palpable
