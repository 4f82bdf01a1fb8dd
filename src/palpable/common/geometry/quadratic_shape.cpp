#include "palpable/common/geometry/quadratic_shape.h"

#include "palpable/common/geometry/tet_mesh.h"

namespace palpable {

QuadraticShape quadratic_shape(const Eigen::Vector4d& L) {
  QuadraticShape shape;
  Eigen::Matrix<double, 4, 10> d = Eigen::Matrix<double, 4, 10>::Zero();  // d/dL_0 .. d/dL_3
  for (int a = 0; a < 4; ++a) {
    shape.N[a] = L[a] * (2.0 * L[a] - 1.0);
    d(a, a) = 4.0 * L[a] - 1.0;
  }
  for (int k = 0; k < 6; ++k) {
    const int a = kTetEdges[k][0], b = kTetEdges[k][1];
    shape.N[4 + k] = 4.0 * L[a] * L[b];
    d(a, 4 + k) = 4.0 * L[b];
    d(b, 4 + k) = 4.0 * L[a];
  }
  shape.slope = d.bottomRows<3>().rowwise() - d.row(0);
  return shape;
}

}  // namespace palpable
