/// @file
/// Neo-Hookean solid in the form of Abaqus and CalculiX (*HYPERELASTIC, NEO HOOKE), for comparing
/// with them; the paper's bodies were computed by Abaqus.
///
///   F      deformation gradient, dx/dX                 (3 x 3)
///   J      det F, volume ratio; J <= 0 is an inverted element
///   I1bar  J^(-2/3) tr(F^T F), which does not change with size
///   P      first Piola-Kirchhoff stress, dPsi/dF       (3 x 3) Pa
#pragma once

#include "palpable/solid/tangent.h"

#include <Eigen/Core>

namespace palpable {

/// Psi(F) = C10 (I1bar - 3) + (J - 1)^2 / D1
///
/// Shape and size are told apart, unlike in eq. (7): the first term resists a change of shape, the
/// second one of size. The second stays finite as J -> 0 and its pressure 2 (1 - J) / D1 is
/// bounded, but J^(-2/3) in the first is not, so that a crushed element still stiffens as long as
/// it is not crushed alike from all sides.
///
/// For small strains this is linear elasticity with shear modulus mu = 2 C10 and bulk modulus
/// kappa = 2 / D1, so lambda = kappa - 2/3 mu.
struct NeoHookeanAbaqus {
  double C10;  ///< Pa, > 0
  double D1;   ///< 1/Pa, > 0: the reciprocal of what eq. (7) calls by this name
};

/// Psi(F), energy per undeformed volume in J/m^3. The formula is finite or complex for J <= 0; we
/// return infinity there, as for the other laws: no body can be in that state.
[[nodiscard]] double energy_density(const NeoHookeanAbaqus& material, const Eigen::Matrix3d& F);

/// P(F) in Pa. @throws ContractViolation if J <= 0, where there is no stress.
[[nodiscard]] Eigen::Matrix3d first_piola(const NeoHookeanAbaqus& material,
                                          const Eigen::Matrix3d& F);

/// dP/dF in Pa. @throws ContractViolation if J <= 0.
[[nodiscard]] Tangent tangent(const NeoHookeanAbaqus& material, const Eigen::Matrix3d& F);

}  // namespace palpable
