#include "palpable/common/geometry/quadrature.h"

#include <cmath>
#include <vector>

namespace palpable {
namespace {

// Gauss' three points of [0, 1].
struct Gauss {
  double x, w;
};
std::array<Gauss, 3> gauss() {
  const double off = 0.5 * std::sqrt(0.6);
  return {Gauss{0.5 - off, 5.0 / 18.0}, Gauss{0.5, 8.0 / 18.0}, Gauss{0.5 + off, 5.0 / 18.0}};
}

}  // namespace

const std::array<QuadraturePoint, 4>& four_point_rule() {
  static const std::array<QuadraturePoint, 4> rule = [] {
    const double near = (5.0 + 3.0 * std::sqrt(5.0)) / 20.0, far = (5.0 - std::sqrt(5.0)) / 20.0;
    std::array<QuadraturePoint, 4> points;
    for (int k = 0; k < 4; ++k) {
      QuadraturePoint& point = points[k];
      point = {Eigen::Vector4d::Constant(far), 0.25};
      point.barycentric[k] = near;
    }
    return points;
  }();
  return rule;
}

// Both rules below are products of Gauss' rule in collapsed coordinates (a, b, c) of the unit cube:
// the barycentric coordinate of corner 0 is 1 - a, and so on. The weights include the Jacobian
// a^2 b (triangle: a).
std::span<const QuadraturePoint> tetrahedron_rule() {
  static const std::vector<QuadraturePoint> rule = [] {
    std::vector<QuadraturePoint> points;
    for (const auto& [a, wa] : gauss()) {
      for (const auto& [b, wb] : gauss()) {
        for (const auto& [c, wc] : gauss()) {
          points.push_back({{1.0 - a, a * (1.0 - b), a * b * (1.0 - c), a * b * c},
                            6.0 * wa * wb * wc * a * a * b});
        }
      }
    }
    return points;
  }();
  return rule;
}

std::span<const QuadraturePoint> triangle_rule() {
  static const std::vector<QuadraturePoint> rule = [] {
    std::vector<QuadraturePoint> points;
    for (const auto& [a, wa] : gauss()) {
      for (const auto& [b, wb] : gauss()) {
        points.push_back({{1.0 - a, a * (1.0 - b), a * b, 0.0}, 2.0 * wa * wb * a});
      }
    }
    return points;
  }();
  return rule;
}

}  // namespace palpable
