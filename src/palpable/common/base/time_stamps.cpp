#include "palpable/common/base/time_stamps.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

// The median of the steps from each time to the next; 0 for fewer than two times.
double median_step(const std::vector<double>& times) {
  if (times.size() < 2) return 0;
  std::vector<double> steps;
  for (std::size_t k = 1; k < times.size(); ++k) {
    steps.push_back(std::abs(times[k] - times[k - 1]));
  }
  const auto middle = steps.begin() + std::ssize(steps) / 2;
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace

std::string_view unit_of_times(const std::vector<double>& times) {
  double largest = 0;
  for (const double time : times) largest = std::max(largest, std::abs(time));
  const double step = median_step(times);
  if (largest > 1e17 || step >= 1e6) return "nanoseconds";
  if (largest > 1e14 || step >= 1e3) return "microseconds";
  return largest > 1e11 ? "milliseconds" : "";
}

std::string what_is_wrong_with_times(const std::vector<double>& times) {
  const std::string_view unit = unit_of_times(times);
  if (unit.empty()) return {};
  const char* divisor = unit.front() == 'n' ? "1e9" : unit == "microseconds" ? "1e6" : "1000";
  return fmt::format(
      "the times are {} to {}, which looks like {}: they should be seconds, so divide them by {}",
      times.front(), times.back(), unit, divisor);
}

}  // namespace palpable
