/// @file
/// Compressible Mooney-Rivlin solid: rubber whose shear resistance depends on both invariants.
///
///   F    deformation gradient, dx/dX                 (3 x 3)
///   J    det F, volume ratio; J <= 0 is an inverted element
///   C    F^T F
///   I1   tr C             I2   (I1^2 - tr C^2) / 2
///   P    first Piola-Kirchhoff stress, dPsi/dF       (3 x 3) Pa
#pragma once

#include "palpable/solid/tangent.h"

#include <Eigen/Core>

namespace palpable {

/// Psi(F) = C1 (I1 - 3 - 2 ln J) + C2 (I2 - 3 - 4 ln J) + D1 (ln J)^2
///
/// The logarithms take away the stress that the invariants would leave at rest. With C2 = 0 this is
/// NeoHookean. For small strains it is linear elasticity with mu = 2 (C1 + C2) and
/// lambda = 2 D1 + 4 C2: I2 resists a change of size as well.
struct MooneyRivlin {
  double C1;  ///< Pa, >= 0
  double C2;  ///< Pa, >= 0, not both zero
  double D1;  ///< Pa, >= 0
};

/// Psi(F), energy per undeformed volume in J/m^3; infinite for J <= 0.
[[nodiscard]] double energy_density(const MooneyRivlin& material, const Eigen::Matrix3d& F);

/// P(F) in Pa. @throws ContractViolation if J <= 0, where there is no stress.
[[nodiscard]] Eigen::Matrix3d first_piola(const MooneyRivlin& material, const Eigen::Matrix3d& F);

/// dP/dF in Pa. @throws ContractViolation if J <= 0.
[[nodiscard]] Tangent tangent(const MooneyRivlin& material, const Eigen::Matrix3d& F);

}  // namespace palpable
