#include "palpable/solid/stress.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"
#include "palpable/solid/shape_gradients.h"

#include <Eigen/LU>
#include <fmt/core.h>

namespace palpable {

StressField element_cauchy_stress(const SolidModel& model, const Eigen::Matrix3Xd& u) {
  const TetMesh& mesh = model.mesh;
  PALPABLE_EXPECT(u.cols() == mesh.node_count(), "one displacement for each node");
  StressField stress(6, mesh.tet_count());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const Eigen::Matrix3d F = deformation_gradient(shape_gradients(mesh, e).g, mesh.tets.col(e), u);
    const double J = F.determinant();
    if (!(J > 0.0)) {
      throw Error(
          fmt::format("element {} is inverted by the displacement (J = {:.3g}); it has no "
                      "stress: use a smaller load",
                      e, J));
    }
    const Eigen::Matrix3d sigma = first_piola(model.material, F) * F.transpose() / J;
    stress.col(e) << sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(2, 0);
  }
  return stress;
}

StressField nodal_cauchy_stress(const SolidModel& model, const Eigen::Matrix3Xd& u) {
  const TetMesh& mesh = model.mesh;
  const StressField elements = element_cauchy_stress(model, u);
  StressField nodal = StressField::Zero(6, mesh.node_count());
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(mesh.node_count());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const double V = shape_gradients(mesh, e).volume;
    for (int a = 0; a < 4; ++a) {
      nodal.col(mesh.tets(a, e)) += V * elements.col(e);
      weight[mesh.tets(a, e)] += V;
    }
  }
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (weight[n] > 0.0) nodal.col(n) /= weight[n];
  }
  return nodal;
}

Eigen::VectorXd von_mises(const StressField& stress) {
  const auto s = stress.array();
  return (0.5 * ((s.row(0) - s.row(1)).square() + (s.row(1) - s.row(2)).square() +
                 (s.row(2) - s.row(0)).square()) +
          3.0 * (s.row(3).square() + s.row(4).square() + s.row(5).square()))
      .sqrt()
      .transpose();
}

}  // namespace palpable
