/// @file
/// The 4-node tetrahedron: shape functions that are linear in the undeformed position.
#pragma once

#include "palpable/geometry/tet_mesh.h"

#include <Eigen/Core>

namespace palpable {

/// Column a: dN_a/dX, 1/m, constant over the element; the columns add up to zero.
struct ShapeGradients {
  Eigen::Matrix<double, 3, 4> g;
  double volume;  ///< m^3, undeformed; negative if the element is inverted
};

/// Gradients of element `e`. Not finite for an element of zero volume.
[[nodiscard]] ShapeGradients shape_gradients(const TetMesh& mesh, int e);

/// F = I + sum_a u_a (dN_a/dX)^T.
/// @param u  (3 x N) m
[[nodiscard]] inline Eigen::Matrix3d deformation_gradient(const Eigen::Matrix<double, 3, 4>& g,
                                                          const Eigen::Vector4i& nodes,
                                                          const Eigen::Matrix3Xd& u) {
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  for (int a = 0; a < 4; ++a) F.noalias() += u.col(nodes[a]) * g.col(a).transpose();
  return F;
}

}  // namespace palpable
