/// @file
/// Compressible neo-Hookean solid (paper eq. 7).
///
///   F    deformation gradient, dx/dX                 (3 x 3)
///   J    det F, volume ratio; J <= 0 is an inverted element
///   I1   tr(F^T F)
///   P    first Piola-Kirchhoff stress, dPsi/dF       (3 x 3) Pa
#pragma once

#include "palpable/common/material/law.h"

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

  static constexpr const char* kName = "neo-hookean";
  static constexpr std::array kConstants{LawConstant{.name = "C1"},
                                         LawConstant{.name = "D1", .may_be_zero = true}};
  static NeoHookean from_lame(LameConstants k) { return {.C1 = 0.5 * k.mu, .D1 = 0.5 * k.lambda}; }
  [[nodiscard]] LameConstants lame() const { return {.lambda = 2.0 * D1, .mu = 2.0 * C1}; }
};

template <class T>
PALPABLE_ALWAYS_INLINE T energy_density(const NeoHookean& law, const Deformation<T>& d) {
  const T ln_J = logarithm(d.J);
  return law.C1 * (d.I1 - 3.0 - 2.0 * ln_J) + law.D1 * ln_J * ln_J;
}

/// P = 2 C1 (F - F^-T) + 2 D1 ln J F^-T, from dI1/dF = 2 F and d(ln J)/dF = F^-T.
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> first_piola(const NeoHookean& law, const Deformation<T>& d) {
  const T ln_J = logarithm(d.J);
  return (2.0 * law.C1) * (d.F - d.G) + T(2.0 * law.D1 * ln_J) * d.G;
}

/// With G = F^-T and dG = -G dF^T G:  dP = 2 C1 dF + (2 C1 - 2 D1 ln J) G dF^T G + 2 D1 (G : dF) G.
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> first_piola_along(const NeoHookean& law, const Deformation<T>& d,
                                                   const Tensor<T>& dF) {
  const T swap = 2.0 * law.C1 - 2.0 * law.D1 * logarithm(d.J);
  return (2.0 * law.C1) * dF + swap * swapped(d.G, dF) + T(2.0 * law.D1 * inner(d.G, dF)) * d.G;
}

}  // namespace palpable
