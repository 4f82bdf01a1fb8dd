/// @file
/// Points and weights for integrals over tetrahedra and triangles.
#pragma once

#include <Eigen/Core>

#include <array>
#include <span>

namespace palpable {

/// A point of a tetrahedron by its barycentric coordinates; of a triangle by the first three, the
/// fourth is 0. The weights of a rule add up to 1: an integral is the volume (area) times
/// sum_q weight_q f(point_q).
struct QuadraturePoint {
  Eigen::Vector4d barycentric;
  double weight;
};

/// Four points, exact for polynomials of degree 2: the products of two gradients in straight-sided
/// 10-node tetrahedra. All points lie inside, all weights are positive.
[[nodiscard]] const std::array<QuadraturePoint, 4>& four_point_rule();

/// 27 points of a tetrahedron, exact for polynomials of degree 3 and accurate for fields that are
/// smooth over an element.
[[nodiscard]] std::span<const QuadraturePoint> tetrahedron_rule();

/// 9 points of a triangle, exact for polynomials of degree 4.
[[nodiscard]] std::span<const QuadraturePoint> triangle_rule();

}  // namespace palpable
