#include "palpable/common/geometry/place_text.h"

#include "palpable/common/base/text_numbers.h"
#include "palpable/common/geometry/size_text.h"

#include <fmt/format.h>

#include <cmath>

namespace palpable {

double told_apart(const Eigen::Matrix3Xd& points) {
  if (points.cols() == 0) return 0.0;
  const double apart = 1e-4 * extent_of(points).norm();
  return std::isfinite(apart) ? apart : 0.0;
}

std::string place_text(const Eigen::Vector3d& point, double apart) {
  constexpr int kFewest = 4, kMost = 17;  // significant digits; 17 tell any two numbers apart
  // Without a scale, four digits are all that can be justified.
  const int most = apart > 0.0 ? kMost : kFewest;
  std::string text;
  for (int digits = kFewest; digits <= most; ++digits) {
    text.clear();
    bool told = true;
    for (const double x : point) {
      const std::string word = fmt::format("{:.{}g}", x, digits);
      told = told && std::abs(to_any_number(word).value_or(x) - x) <= 0.5 * apart;
      text += (text.empty() ? "" : ", ") + word;
    }
    if (told) break;
  }
  return fmt::format("({})", text);
}

}  // namespace palpable
