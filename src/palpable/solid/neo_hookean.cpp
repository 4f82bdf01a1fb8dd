#include "palpable/solid/neo_hookean.h"

#include "palpable/base/contract.h"

#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace palpable {

using Eigen::Matrix3d;

double energy_density(const NeoHookean& material, const Matrix3d& F) {
  const auto [C1, D1] = material;
  const double J = F.determinant();
  if (!(J > 0.0)) return std::numeric_limits<double>::infinity();
  const double I1 = F.squaredNorm();
  const double ln_J = std::log(J);
  return C1 * (I1 - 3.0 - 2.0 * ln_J) + D1 * ln_J * ln_J;
}

Matrix3d first_piola(const NeoHookean& material, const Matrix3d& F) {
  const auto [C1, D1] = material;
  const double J = F.determinant();
  PALPABLE_EXPECT(J > 0.0, "an inverted element has no stress");
  // dI1/dF = 2 F  and  d(ln J)/dF = F^-T  give
  // P = 2 C1 (F - F^-T) + 2 D1 ln J F^-T
  const Matrix3d F_inv_T = F.inverse().transpose();
  return 2.0 * C1 * (F - F_inv_T) + 2.0 * D1 * std::log(J) * F_inv_T;
}

Tangent tangent(const NeoHookean& material, const Matrix3d& F) {
  const auto [C1, D1] = material;
  const double J = F.determinant();
  PALPABLE_EXPECT(J > 0.0, "an inverted element has no stress");
  // With G = F^-T:  dG_iJ / dF_kL = -G_iL G_kJ, so
  // A_iJkL = 2 C1 d_ik d_JL + (2 C1 - 2 D1 ln J) G_iL G_kJ + 2 D1 G_iJ G_kL
  const Matrix3d G = F.inverse().transpose();
  const double swapped = 2.0 * C1 - 2.0 * D1 * std::log(J);
  Tangent A;
  for (int L = 0; L < 3; ++L) {
    for (int k = 0; k < 3; ++k) {
      for (int K = 0; K < 3; ++K) {
        A.col(k + 3 * L).segment<3>(3 * K) =
            swapped * G(k, K) * G.col(L) + 2.0 * D1 * G(k, L) * G.col(K);
      }
      A(k + 3 * L, k + 3 * L) += 2.0 * C1;
    }
  }
  return A;
}

}  // namespace palpable
