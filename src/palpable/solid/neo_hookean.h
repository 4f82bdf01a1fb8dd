/// @file
/// Compressible neo-Hookean solid (paper eq. 7).
///
///   F    deformation gradient, dx/dX                 (3 x 3)
///   J    det F, volume ratio; J <= 0 is an inverted element
///   I1   tr(F^T F)
///   P    first Piola-Kirchhoff stress, dPsi/dF       (3 x 3) Pa
#pragma once

#include "palpable/solid/tangent.h"

#include <Eigen/Core>

namespace palpable {

/// Psi(F) = C1 (I1 - 3 - 2 ln J) + D1 (ln J)^2
///
/// Eq. (7) prints the isochoric invariant J^(-2/3) I1. Its derivative at F = I is zero, which
/// leaves that of -2 C1 ln J alone: a body at rest would carry the stress -2 C1 I. So we read the
/// full I1; the test "eq. (7) as printed is not free of stress at rest" has the calculation.
///
/// For small strains this is linear elasticity with Lame constants mu = 2 C1 and lambda = 2 D1.
struct NeoHookean {
  double C1;  ///< Pa, > 0
  double D1;  ///< Pa, >= 0
};

/// Psi(F), energy per undeformed volume in J/m^3. Infinite for J <= 0, which is what lets a line
/// search back away from an inverted element instead of stopping.
[[nodiscard]] double energy_density(const NeoHookean& material, const Eigen::Matrix3d& F);

/// P(F) in Pa. @throws ContractViolation if J <= 0, where there is no stress.
[[nodiscard]] Eigen::Matrix3d first_piola(const NeoHookean& material, const Eigen::Matrix3d& F);

/// dP/dF in Pa. @throws ContractViolation if J <= 0.
[[nodiscard]] Tangent tangent(const NeoHookean& material, const Eigen::Matrix3d& F);

}  // namespace palpable
