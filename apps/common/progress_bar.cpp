#include "apps/common/progress_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unistd.h>

namespace palpable::app {
namespace {

constexpr int kBarWidth = 24;
constexpr double kRedrawSeconds = 0.1;
constexpr double kLogSeconds = 5.0;
// Too little to extrapolate from.
constexpr double kLeastFraction = 0.02;

double seconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double>(d).count();
}

}  // namespace

std::string duration_text(double seconds) {
  const auto s = static_cast<long>(std::lround(seconds));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
}

std::string progress_line(const ProgressReport& report, double elapsed, int bar_width,
                          double begun) {
  const double fraction = std::clamp(report.done / report.total, 0.0, 1.0);
  std::string line = fmt::format("{:<22}", report.task);
  if (bar_width > 0) {
    const int full = static_cast<int>(fraction * bar_width);
    line += fmt::format(" [{:#<{}}{:.<{}}]", "", full, "", bar_width - full);
  }
  line += fmt::format(" {:3.0f} %", 100.0 * fraction);
  if (fraction >= 1.0) {
    line += fmt::format("  {}", duration_text(elapsed));
  } else if (fraction - begun >= kLeastFraction) {
    line +=
        fmt::format("  {} left", duration_text(elapsed * (1.0 - fraction) / (fraction - begun)));
  }
  if (!report.note.empty()) line += "  " + report.note;
  return line;
}

ProgressBar::ProgressBar(std::FILE* stream)
    : ProgressBar(stream, ::isatty(::fileno(stream)) != 0) {}

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

// Not fmt::print, which throws: a terminal that was closed is no reason to lose the work.
void ProgressBar::print(const std::string& text) {
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
    if (!terminal_) drawn_ = now;  // a log needs no line for a task that has just begun
  }
  last_line_ = progress_line(report, seconds(now - begin_), terminal_ ? kBarWidth : 0, begun_);
  shown_last_ = false;
  if (seconds(now - drawn_) < (terminal_ ? kRedrawSeconds : kLogSeconds)) return;
  drawn_ = now;
  shown_last_ = true;
  print(terminal_ ? fmt::format("\r{}\x1b[K", last_line_) : last_line_ + "\n");
}

}  // namespace palpable::app
