/// @file
/// Progress of long work on stderr: a bar with the remaining time on a terminal, or occasional
/// lines elsewhere (a log file, CI).
#pragma once

#include "palpable/common/base/progress.h"

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>

namespace palpable::app {

/// Shows one task after another. Used as a Progress:
///
///     ProgressBar bar;
///     bake_body(description, settings, bar.progress());
///
/// The destructor ends the line of an open bar, so that later output starts on a line of its own.
/// Failures to print, e.g. on a closed terminal, are ignored.
class ProgressBar {
 public:
  /// Prints nothing if the user wants quiet (printing.h).
  /// @param stream    output; stderr except in tests
  /// @param terminal  true: redraw one line; false: print few lines
  explicit ProgressBar(std::FILE* stream = stderr);
  ProgressBar(std::FILE* stream, bool terminal);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar();

  void show(const ProgressReport& report);
  /// Ends the line of an open bar, as the destructor does.
  void finish();
  /// Prints a line that is not progress, after ending the line of an open bar.
  void say(std::string_view line);

  /// A function that shows its reports here; valid as long as this object.
  [[nodiscard]] Progress progress() {
    return [this](const ProgressReport& report) { show(report); };
  }

 private:
  using Clock = std::chrono::steady_clock;

  void print(const std::string& text);

  std::FILE* stream_;
  bool terminal_;
  bool quiet_ = false;       // -q: nothing is printed
  std::string task_;         // the present task; empty before the first
  std::string last_line_;    // the task's last line, printed at its end
  bool shown_last_ = false;  // last_line_ is on the screen
  Clock::time_point begin_;  // start of the task
  double begun_ = 0;         // fraction done at begin_
  Clock::time_point drawn_;  // last time at which something was drawn
};

}  // namespace palpable::app
