#include "palpable/solid/mooney_rivlin.h"

#include "palpable/base/contract.h"

#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace palpable {

using Eigen::Matrix3d;

double energy_density(const MooneyRivlin& material, const Matrix3d& F) {
  const auto [C1, C2, D1] = material;
  const double J = F.determinant();
  if (!(J > 0.0)) return std::numeric_limits<double>::infinity();
  const Matrix3d C = F.transpose() * F;
  const double I1 = C.trace(), I2 = 0.5 * (I1 * I1 - C.squaredNorm());
  const double ln_J = std::log(J);
  return C1 * (I1 - 3.0 - 2.0 * ln_J) + C2 * (I2 - 3.0 - 4.0 * ln_J) + D1 * ln_J * ln_J;
}

Matrix3d first_piola(const MooneyRivlin& material, const Matrix3d& F) {
  const auto [C1, C2, D1] = material;
  const double J = F.determinant();
  PALPABLE_EXPECT(J > 0.0, "an inverted element has no stress");
  // dI1/dF = 2 F,  dI2/dF = 2 (I1 F - F C),  d(ln J)/dF = F^-T
  const Matrix3d F_inv_T = F.inverse().transpose();
  const Matrix3d C = F.transpose() * F;
  return 2.0 * C1 * (F - F_inv_T) + 2.0 * C2 * (C.trace() * F - F * C - 2.0 * F_inv_T) +
         2.0 * D1 * std::log(J) * F_inv_T;
}

Tangent tangent(const MooneyRivlin& material, const Matrix3d& F) {
  const auto [C1, C2, D1] = material;
  const double J = F.determinant();
  PALPABLE_EXPECT(J > 0.0, "an inverted element has no stress");
  // With G = F^-T, B = F F^T, C = F^T F and dG_iJ / dF_kL = -G_iL G_kJ:
  // A_iJkL = 2 (C1 + C2 I1) d_ik d_JL - 2 C2 (d_ik C_LJ + F_iL F_kJ + B_ik d_JL - 2 F_iJ F_kL)
  //          + (2 C1 + 4 C2 - 2 D1 ln J) G_iL G_kJ + 2 D1 G_iJ G_kL
  const Matrix3d G = F.inverse().transpose();
  const Matrix3d C = F.transpose() * F, B = F * F.transpose();
  const double swapped = 2.0 * C1 + 4.0 * C2 - 2.0 * D1 * std::log(J);
  Tangent A;
  for (int L = 0; L < 3; ++L) {
    for (int k = 0; k < 3; ++k) {
      for (int K = 0; K < 3; ++K) {
        auto column = A.col(k + 3 * L).segment<3>(3 * K);
        column = swapped * G(k, K) * G.col(L) + 2.0 * D1 * G(k, L) * G.col(K) -
                 2.0 * C2 * F(k, K) * F.col(L) + 4.0 * C2 * F(k, L) * F.col(K);
        column[k] -= 2.0 * C2 * C(L, K);
        if (K == L) {
          column -= 2.0 * C2 * B.col(k);
          column[k] += 2.0 * (C1 + C2 * C.trace());
        }
      }
    }
  }
  return A;
}

}  // namespace palpable
