#include "palpable/solid/saint_venant_kirchhoff.h"

#include <Eigen/LU>

#include <limits>

namespace palpable {

using Eigen::Matrix3d;

namespace {
Matrix3d green_strain(const Matrix3d& F) {
  return 0.5 * (F.transpose() * F - Matrix3d::Identity());
}

Matrix3d second_piola(const SaintVenantKirchhoff& material, const Matrix3d& F) {
  const Matrix3d E = green_strain(F);
  return material.lambda * E.trace() * Matrix3d::Identity() + 2.0 * material.mu * E;
}
}  // namespace

double energy_density(const SaintVenantKirchhoff& material, const Matrix3d& F) {
  if (!(F.determinant() > 0.0)) return std::numeric_limits<double>::infinity();
  const Matrix3d E = green_strain(F);
  const double trace = E.trace();
  return 0.5 * material.lambda * trace * trace + material.mu * E.squaredNorm();
}

Matrix3d first_piola(const SaintVenantKirchhoff& material, const Matrix3d& F) {
  return F * second_piola(material, F);
}

Tangent tangent(const SaintVenantKirchhoff& material, const Matrix3d& F) {
  const auto [lambda, mu] = material;
  // dP = dF S + lambda (F : dF) F + mu F dF^T F + mu F F^T dF, that is
  // A_iJkL = d_ik S_JL + lambda F_iJ F_kL + mu F_iL F_kJ + mu (F F^T)_ik d_JL
  const Matrix3d S = second_piola(material, F);
  const Matrix3d B = F * F.transpose();
  Tangent A;
  for (int L = 0; L < 3; ++L) {
    for (int k = 0; k < 3; ++k) {
      auto column = A.col(k + 3 * L);
      for (int J = 0; J < 3; ++J) {
        column.segment<3>(3 * J) = lambda * F(k, L) * F.col(J) + mu * F(k, J) * F.col(L);
        column[k + 3 * J] += S(J, L);
      }
      column.segment<3>(3 * L) += mu * B.col(k);
    }
  }
  return A;
}

}  // namespace palpable
