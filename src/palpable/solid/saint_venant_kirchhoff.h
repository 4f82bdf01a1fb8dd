/// @file
/// St. Venant-Kirchhoff solid: Hooke's law between Green's strain and the second Piola stress.
///
///   F    deformation gradient, dx/dX                 (3 x 3)
///   E    Green's strain, (F^T F - I) / 2             (3 x 3)
///   S    second Piola-Kirchhoff stress, dPsi/dE      (3 x 3) Pa
///   P    first Piola-Kirchhoff stress, F S           (3 x 3) Pa
#pragma once

#include "palpable/solid/tangent.h"

#include <Eigen/Core>

namespace palpable {

/// Psi(F) = lambda/2 (tr E)^2 + mu E : E
///
/// The textbook law for large rotations and small strains. It softens in strong compression: a
/// bar pressed below 1/sqrt(3) = 0.58 of its length (uniaxial strain) needs less force the shorter
/// it gets, and nothing in the formula keeps an element from being turned inside out. So loads must
/// be bounded, and a path stops where the body collapses.
struct SaintVenantKirchhoff {
  double lambda;  ///< Pa, >= 0
  double mu;      ///< Pa, > 0
};

/// Psi(F), energy per undeformed volume in J/m^3. The formula is finite for J <= 0; we return
/// infinity there, as for the other laws: no body can be in that state.
[[nodiscard]] double energy_density(const SaintVenantKirchhoff& material, const Eigen::Matrix3d& F);

/// P(F) in Pa. Defined by the formula for every F.
[[nodiscard]] Eigen::Matrix3d first_piola(const SaintVenantKirchhoff& material,
                                          const Eigen::Matrix3d& F);

/// dP/dF in Pa. Defined by the formula for every F.
[[nodiscard]] Tangent tangent(const SaintVenantKirchhoff& material, const Eigen::Matrix3d& F);

}  // namespace palpable
