/// @file
/// Shape functions of the 4-node and the 10-node tetrahedron.
#pragma once

#include "palpable/common/geometry/quadratic_shape.h"
#include "palpable/common/geometry/tet_mesh.h"

#include <Eigen/Core>

namespace palpable {

/// The 4-node tetrahedron. Column a: dN_a/dX, 1/m, constant over the element; the columns add up to
/// zero.
struct ShapeGradients {
  Eigen::Matrix<double, 3, 4> g;
  double volume;  ///< m^3, undeformed; negative if the element is inverted
};

/// Gradients of element `e` from its corners alone; edge nodes are ignored. Not finite for zero
/// volume.
[[nodiscard]] ShapeGradients shape_gradients(const TetMesh& mesh, int e);

namespace detail {
// Forced inline: it is called at every integration point of every pass, and compilers do not inline
// it by themselves.
template <class Gradients, class Nodes>
[[gnu::always_inline]] inline Eigen::Matrix3d deformation_gradient(const Gradients& g,
                                                                   const Nodes& nodes,
                                                                   const Eigen::Matrix3Xd& u) {
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  for (int a = 0; a < Gradients::ColsAtCompileTime; ++a) {
    F.noalias() += u.col(nodes[a]) * g.col(a).transpose();
  }
  return F;
}
}  // namespace detail

/// F = I + sum_a u_a (dN_a/dX)^T.
/// @param u  (3 x N) m
[[nodiscard]] inline Eigen::Matrix3d deformation_gradient(const Eigen::Matrix<double, 3, 4>& g,
                                                          const Eigen::Vector4i& nodes,
                                                          const Eigen::Matrix3Xd& u) {
  return detail::deformation_gradient(g, nodes, u);
}
[[nodiscard]] inline Eigen::Matrix3d deformation_gradient(const Eigen::Matrix<double, 3, 10>& g,
                                                          const Eigen::Matrix<int, 10, 1>& nodes,
                                                          const Eigen::Matrix3Xd& u) {
  return detail::deformation_gradient(g, nodes, u);
}

/// Node indices of element `e` of a quadratic mesh: corners, then edges.
[[nodiscard]] Eigen::Matrix<int, 10, 1> quadratic_nodes(const TetMesh& mesh, int e);

/// dN_a/dX at one point of a 10-node tetrahedron, isoparametric: edges need not be straight.
struct QuadraticGradients {
  Eigen::Matrix<double, 3, 10> g;
  double volume;  ///< m^3, det(dX/dL) / 6 there; the element's volume if its edges are straight
};
/// Gradients of element `e` of a mesh of 10-node tetrahedra at the point of `shape`.
[[nodiscard]] QuadraticGradients quadratic_gradients(const TetMesh& mesh, int e,
                                                     const QuadraticShape& shape);

}  // namespace palpable
