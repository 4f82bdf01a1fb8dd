/// @file
/// Shape functions of the 10-node tetrahedron. They need no mesh, so that the live half can use
/// them.
#pragma once

#include <Eigen/Core>

namespace palpable {

/// The 10-node tetrahedron at one point: corners first, then edges as in kTetEdges.
///
///     N_a = L_a (2 L_a - 1) at corners,  N_ab = 4 L_a L_b on edges   (L barycentric coordinates)
///
/// On the face L_3 = 0, the corners 0 1 2 and the edge nodes 4 5 6 form the 6-node triangle.
struct QuadraticShape {
  Eigen::Matrix<double, 10, 1> N;
  Eigen::Matrix<double, 3, 10> slope;  ///< d/dL_1, d/dL_2, d/dL_3 with L_0 = 1 - L_1 - L_2 - L_3
};
/// Shape functions and their slopes at the barycentric coordinates L_0 .. L_3.
[[nodiscard]] QuadraticShape quadratic_shape(const Eigen::Vector4d& barycentric);

}  // namespace palpable
