/// @file
/// Integrals over tetrahedra and triangles for manufactured solutions.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <vector>

namespace palpable::test {

/// A point of a tetrahedron by its four barycentric coordinates (of a triangle by its first three;
/// the fourth is 0), with a weight that sums to 1 over all points.
struct QuadraturePoint {
  Eigen::Vector4d barycentric;
  double weight;
};

/// Products of the three-point Gauss rule in collapsed coordinates: exact for polynomials of degree
/// 3 on a tetrahedron (27 points), where piecewise linear fields need 2 and smooth ones, seen at
/// the element's size, little more.
inline const std::vector<QuadraturePoint>& tetrahedron_rule() {
  static const std::vector<QuadraturePoint> rule = [] {
    const double s = 0.5 * std::sqrt(0.6);
    const std::array<double, 3> x{0.5 - s, 0.5, 0.5 + s}, w{5.0 / 18, 8.0 / 18, 5.0 / 18};
    std::vector<QuadraturePoint> points;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t k = 0; k < 3; ++k) {
          // (a, b, c) in the unit cube -> corner 0 takes 1 - a, the rest is shared alike.
          const double a = x[i], b = x[j], c = x[k];
          points.push_back({{1 - a, a * (1 - b), a * b * (1 - c), a * b * c},
                            6.0 * w[i] * w[j] * w[k] * a * a * b});
        }
      }
    }
    return points;
  }();
  return rule;
}

/// The same for a triangle: 9 points, exact for degree 4.
inline const std::vector<QuadraturePoint>& triangle_rule() {
  static const std::vector<QuadraturePoint> rule = [] {
    const double s = 0.5 * std::sqrt(0.6);
    const std::array<double, 3> x{0.5 - s, 0.5, 0.5 + s}, w{5.0 / 18, 8.0 / 18, 5.0 / 18};
    std::vector<QuadraturePoint> points;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        const double a = x[i], b = x[j];
        points.push_back({{1 - a, a * (1 - b), a * b, 0}, 2.0 * w[i] * w[j] * a});
      }
    }
    return points;
  }();
  return rule;
}

}  // namespace palpable::test
