#include "palpable/common/base/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

// Fraction of the work below which the time left is not extrapolated.
constexpr double kLeastFraction = 0.02;

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

}  // namespace palpable
