#include "palpable/solid/shape_gradients.h"

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

}  // namespace palpable
