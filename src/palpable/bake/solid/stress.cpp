#include "palpable/bake/solid/stress.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/quadrature.h"
#include "palpable/common/geometry/shape_gradients.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/core.h>

#include <array>
#include <vector>

namespace palpable {

using Eigen::Matrix3d;

namespace {

// Calls visit(e, q, gradients, nodes, volume) at every integration point.
template <class Visit>
void for_each_point(const TetMesh& mesh, const Visit& visit) {
  if (!mesh.is_quadratic()) {
    for (int e = 0; e < mesh.tet_count(); ++e) {
      const ShapeGradients shape = shape_gradients(mesh, e);
      visit(e, 0, shape.g, Eigen::Vector4i(mesh.tets.col(e)), shape.volume);
    }
    return;
  }
  std::array<QuadraticShape, 4> shapes;
  for (std::size_t q = 0; q < 4; ++q) shapes[q] = quadratic_shape(four_point_rule()[q].barycentric);
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const Eigen::Matrix<int, 10, 1> nodes = quadratic_nodes(mesh, e);
    for (int q = 0; q < 4; ++q) {
      const QuadraticGradients at = quadratic_gradients(mesh, e, shapes[q]);
      visit(e, q, at.g, nodes, four_point_rule()[q].weight * at.volume);
    }
  }
}

}  // namespace

StressField point_cauchy_stress(const SolidModel& model, const Eigen::Matrix3Xd& u) {
  const TetMesh& mesh = model.mesh;
  PALPABLE_EXPECT(u.cols() == mesh.node_count(), "one displacement for each node");
  const int Q = mesh.is_quadratic() ? 4 : 1;
  const std::vector<int> group_of = material_groups(model);
  StressField stress(6, Q * mesh.tet_count());
  for_each_point(mesh, [&](int e, int q, const auto& g, const auto& nodes, double /*volume*/) {
    const Matrix3d F = deformation_gradient(g, nodes, u);
    const double J = F.determinant();
    if (!(J > 0.0)) {
      throw Error(
          fmt::format("element {} is inverted by the displacement (J = {:.3g}); it has no "
                      "stress: use a smaller load",
                      e, J));
    }
    const int group = group_of[e];
    const Material& material = group < 0 ? model.material : model.groups[group].material;
    const Matrix3d sigma = first_piola(material, F) * F.transpose() / J;
    stress.col(Q * e + q) << sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2),
        sigma(2, 0);
  });
  return stress;
}

StressField element_cauchy_stress(const SolidModel& model, const Eigen::Matrix3Xd& u) {
  const StressField points = point_cauchy_stress(model, u);
  if (!model.mesh.is_quadratic()) return points;
  StressField stress = StressField::Zero(6, model.mesh.tet_count());
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(model.mesh.tet_count());
  for_each_point(model.mesh, [&](int e, int q, const auto&, const auto&, double V) {
    stress.col(e) += V * points.col(4 * e + q);
    volume[e] += V;
  });
  for (Eigen::Index e = 0; e < stress.cols(); ++e) stress.col(e) /= volume[e];
  return stress;
}

StressField nodal_cauchy_stress(const SolidModel& model, const Eigen::Matrix3Xd& u,
                                const StressRecovery& recovery) {
  return recovery.apply(point_cauchy_stress(model, u));
}

StressField nodal_cauchy_stress(const SolidModel& model, const Eigen::Matrix3Xd& u) {
  return nodal_cauchy_stress(model, u, StressRecovery(model.mesh));
}

Eigen::Matrix3Xd principal_stresses(const StressField& stress) {
  Eigen::Matrix3Xd principal(3, stress.cols());
  for (Eigen::Index n = 0; n < stress.cols(); ++n) {
    const auto s = stress.col(n);
    Matrix3d tensor;
    tensor << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    principal.col(n) = Eigen::SelfAdjointEigenSolver<Matrix3d>(tensor, Eigen::EigenvaluesOnly)
                           .eigenvalues()
                           .reverse();
  }
  return principal;
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
