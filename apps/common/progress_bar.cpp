#include "apps/common/progress_bar.h"

#include "apps/common/printing.h"
#include "palpable/common/base/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <unistd.h>

namespace palpable::app {
namespace {

constexpr int kBarWidth = 24;
constexpr double kRedrawSeconds = 0.1;
constexpr double kLogSeconds = 5.0;

double seconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double>(d).count();
}

}  // namespace

ProgressBar::ProgressBar(std::FILE* stream) : ProgressBar(stream, ::isatty(::fileno(stream)) != 0) {
  quiet_ = verbosity() == Verbosity::kQuiet;
}

ProgressBar::ProgressBar(std::FILE* stream, bool terminal) : stream_(stream), terminal_(terminal) {}

ProgressBar::~ProgressBar() { finish(); }

void ProgressBar::finish() {
  if (task_.empty()) return;
  if (terminal_) {
    print(fmt::format("\r{}\x1b[K\n", last_line_));
  } else if (!shown_last_) {
    print(last_line_ + "\n");
  }
  task_.clear();
}

void ProgressBar::say(std::string_view line) {
  finish();
  print(fmt::format("{}\n", line));
}

// Not fmt::print(), which throws: the work must not be lost because a terminal was closed.
void ProgressBar::print(const std::string& text) {
  if (quiet_) return;
  std::fputs(text.c_str(), stream_);
  std::fflush(stream_);
}

void ProgressBar::show(const ProgressReport& report) {
  const Clock::time_point now = Clock::now();
  if (report.task != task_) {
    finish();
    task_ = report.task;
    begin_ = now;
    begun_ = std::clamp(report.done / report.total, 0.0, 1.0);
    drawn_ = now - std::chrono::hours(1);
    if (!terminal_) drawn_ = now;  // no line for a task that has just begun
  }
  last_line_ = progress_line(report, seconds(now - begin_), terminal_ ? kBarWidth : 0, begun_);
  shown_last_ = false;
  if (seconds(now - drawn_) < (terminal_ ? kRedrawSeconds : kLogSeconds)) return;
  drawn_ = now;
  shown_last_ = true;
  print(terminal_ ? fmt::format("\r{}\x1b[K", last_line_) : last_line_ + "\n");
}

}  // namespace palpable::app
