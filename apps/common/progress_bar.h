/// @file
/// How far long work is, on stderr: a bar with the remaining time, or plain lines now and then
/// where stderr is no terminal (a log file, CI).
#pragma once

#include "palpable/common/base/progress.h"

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>

namespace palpable::app {

/// One task after another. To be used as a Progress:
///
///     ProgressBar bar;
///     bake_body(description, settings, bar.progress());
///
/// The destructor ends an open bar's line, so what is printed next starts on a line of its own.
/// Where nothing can be printed, on a terminal that was closed, the work goes on without a word.
class ProgressBar {
 public:
  /// @param stream    where to draw; stderr, unless a test looks at it
  /// @param terminal  redraw one line (true) or print few lines (false)
  explicit ProgressBar(std::FILE* stream = stderr);
  ProgressBar(std::FILE* stream, bool terminal);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar();

  void show(const ProgressReport& report);
  /// Ends an open bar's line, as the destructor does.
  void finish();
  /// A line of its own, for what is not progress; an open bar's line ends before it.
  void say(std::string_view line);

  /// A function that shows reports here; valid as long as this object.
  [[nodiscard]] Progress progress() {
    return [this](const ProgressReport& report) { show(report); };
  }

 private:
  using Clock = std::chrono::steady_clock;

  void print(const std::string& text);

  std::FILE* stream_;
  bool terminal_;
  std::string task_;         // the task being shown; empty before the first
  std::string last_line_;    // of it, for its end
  bool shown_last_ = false;  // last_line_ has been printed
  Clock::time_point begin_;  // of the task
  double begun_ = 0;         // fraction done at that time
  Clock::time_point drawn_;  // when something was last drawn
};

}  // namespace palpable::app
