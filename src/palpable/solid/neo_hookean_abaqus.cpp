#include "palpable/solid/neo_hookean_abaqus.h"

#include "palpable/base/contract.h"

#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace palpable {

using Eigen::Matrix3d;

double energy_density(const NeoHookeanAbaqus& material, const Matrix3d& F) {
  const auto [C10, D1] = material;
  const double J = F.determinant();
  if (!(J > 0.0)) return std::numeric_limits<double>::infinity();
  const double I1_bar = std::pow(J, -2.0 / 3.0) * F.squaredNorm();
  return C10 * (I1_bar - 3.0) + (J - 1.0) * (J - 1.0) / D1;
}

Matrix3d first_piola(const NeoHookeanAbaqus& material, const Matrix3d& F) {
  const auto [C10, D1] = material;
  const double J = F.determinant();
  PALPABLE_EXPECT(J > 0.0, "an inverted element has no stress");
  // dI1/dF = 2 F  and  dJ/dF = J F^-T  give
  // P = 2 C10 J^(-2/3) (F - I1/3 F^-T) + 2/D1 (J - 1) J F^-T
  const Matrix3d F_inv_T = F.inverse().transpose();
  const double I1 = F.squaredNorm();
  return 2.0 * C10 * std::pow(J, -2.0 / 3.0) * (F - I1 / 3.0 * F_inv_T) +
         2.0 / D1 * (J - 1.0) * J * F_inv_T;
}

Tangent tangent(const NeoHookeanAbaqus& material, const Matrix3d& F) {
  const auto [C10, D1] = material;
  const double J = F.determinant();
  PALPABLE_EXPECT(J > 0.0, "an inverted element has no stress");
  // With G = F^-T, a = 2 C10 J^(-2/3) and b = 2/D1 (J - 1) J:
  //   P = a (F - I1/3 G) + b G,   dG_iJ / dF_kL = -G_iL G_kJ,   da/dF = -2/3 a G, so
  // A_iJkL = a d_ik d_JL - 2/3 a (F_iJ G_kL + G_iJ F_kL)
  //          + (2/9 a I1 + 2/D1 (2 J - 1) J) G_iJ G_kL + (a I1/3 - b) G_iL G_kJ
  const Matrix3d G = F.inverse().transpose();
  const double I1 = F.squaredNorm();
  const double a = 2.0 * C10 * std::pow(J, -2.0 / 3.0);
  const double swapped = a * I1 / 3.0 - 2.0 / D1 * (J - 1.0) * J;
  const double straight = 2.0 / 9.0 * a * I1 + 2.0 / D1 * (2.0 * J - 1.0) * J;
  Tangent A;
  for (int L = 0; L < 3; ++L) {
    for (int k = 0; k < 3; ++k) {
      for (int K = 0; K < 3; ++K) {
        A.col(k + 3 * L).segment<3>(3 * K) =
            swapped * G(k, K) * G.col(L) +
            (straight * G(k, L) - 2.0 / 3.0 * a * F(k, L)) * G.col(K) -
            2.0 / 3.0 * a * G(k, L) * F.col(K);
      }
      A(k + 3 * L, k + 3 * L) += a;
    }
  }
  return A;
}

}  // namespace palpable
