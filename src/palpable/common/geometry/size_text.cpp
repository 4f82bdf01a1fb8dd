#include "palpable/common/geometry/size_text.h"

#include <fmt/format.h>

namespace palpable {
namespace {

template <class Size>
std::string text_of(const Size& size) {
  const bool metres = size.maxCoeff() >= 1.0;
  std::string text;
  for (const double side : size) {
    text += fmt::format("{}{:.3g}", text.empty() ? "" : " x ", metres ? side : 1e3 * side);
  }
  text += metres ? " m" : " mm";
  return text;
}

}  // namespace

Eigen::Vector3d extent_of(const Eigen::Matrix3Xd& points) {
  return points.rowwise().maxCoeff() - points.rowwise().minCoeff();
}

std::string size_text(const Eigen::Vector3d& size) { return text_of(size); }

std::string size_text(const Eigen::Vector2d& size) { return text_of(size); }

}  // namespace palpable
