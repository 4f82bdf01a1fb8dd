#include "palpable/common/geometry/shape_gradients.h"

#include <Eigen/LU>

namespace palpable {

ShapeGradients shape_gradients(const TetMesh& mesh, int e) {
  // X = X0 + D (N1 N2 N3)^T, so the rows of D^-1 are the gradients of N1, N2, N3.
  Eigen::Matrix3d D;
  for (int k = 0; k < 3; ++k) {
    D.col(k) = mesh.nodes.col(mesh.tets(k + 1, e)) - mesh.nodes.col(mesh.tets(0, e));
  }
  ShapeGradients shape;
  shape.g.rightCols<3>() = D.inverse().transpose();
  shape.g.col(0) = -shape.g.rightCols<3>().rowwise().sum();
  shape.volume = D.determinant() / 6.0;
  return shape;
}

Eigen::Matrix<int, 10, 1> quadratic_nodes(const TetMesh& mesh, int e) {
  Eigen::Matrix<int, 10, 1> nodes;
  nodes << mesh.tets.col(e), mesh.edge_nodes.col(e);
  return nodes;
}

QuadraticGradients quadratic_gradients(const TetMesh& mesh, int e, const QuadraticShape& shape) {
  Eigen::Matrix3d D = Eigen::Matrix3d::Zero();  // dX/dL
  for (int a = 0; a < 10; ++a) {
    const int n = a < 4 ? mesh.tets(a, e) : mesh.edge_nodes(a - 4, e);
    D += mesh.nodes.col(n) * shape.slope.col(a).transpose();
  }
  return {D.inverse().transpose() * shape.slope, D.determinant() / 6.0};
}

}  // namespace palpable
