#include "palpable/bake/mesh/inp_motion.h"

#include "palpable/bake/mesh/inp_keyword.h"
#include "palpable/common/base/text_numbers.h"

#include <numbers>

namespace palpable::inp {

std::optional<Eigen::Isometry3d> instance_motion(const std::vector<std::string_view>& lines) {
  using Eigen::Vector3d;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  for (std::size_t k = 0; k < lines.size(); ++k) {
    std::vector<double> numbers;
    for (const std::string_view word : split(lines[k])) {
      const std::optional<double> number = to_number(word);
      if (!number) return std::nullopt;
      numbers.push_back(*number);
    }
    if (k == 0 && numbers.size() == 3) {
      motion.translation() = Eigen::Map<const Vector3d>(numbers.data());
    } else if (k == 1 && numbers.size() == 7) {
      const Eigen::Map<const Vector3d> a(numbers.data()), b(numbers.data() + 3);
      const double length = (b - a).norm();
      if (!(length > 0.0)) return std::nullopt;
      const Eigen::AngleAxisd turn(numbers[6] * std::numbers::pi / 180.0, (b - a) / length);
      motion = Eigen::Translation3d(a) * turn * Eigen::Translation3d(-a) * motion;
    } else {
      return std::nullopt;
    }
  }
  return motion;
}

}  // namespace palpable::inp
