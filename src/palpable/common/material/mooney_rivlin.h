/// @file
/// Compressible Mooney-Rivlin solid: rubber whose shear resistance depends on both invariants.
///
///   F    deformation gradient, dx/dX                 (3 x 3)
///   J    det F, volume ratio; J <= 0 is an inverted element
///   C    F^T F
///   I1   tr C             I2   (I1^2 - tr C^2) / 2
///   P    first Piola-Kirchhoff stress, dPsi/dF       (3 x 3) Pa
#pragma once

#include "palpable/common/material/law.h"

namespace palpable {

/// Psi(F) = C1 (I1 - 3 - 2 ln J) + C2 (I2 - 3 - 4 ln J) + D1 (ln J)^2
///
/// The logarithms cancel the stress that the invariants alone would have at rest. With C2 = 0 this
/// is NeoHookean. For small strains it is linear elasticity with mu = 2 (C1 + C2) and lambda = 2 D1
/// + 4 C2: I2 resists a change of size as well.
struct MooneyRivlin {
  double C1;  ///< Pa, >= 0
  double C2;  ///< Pa, >= 0, not both zero
  double D1;  ///< Pa, >= 0

  static constexpr const char* kName = "mooney-rivlin";
  static constexpr std::array kConstants{LawConstant{.name = "C1", .may_be_zero = true},
                                         LawConstant{.name = "C2", .may_be_zero = true},
                                         LawConstant{.name = "D1", .may_be_zero = true}};
  /// Chooses C2 = C1 / 4, as in filled rubbers, or less if Poisson's ratio is so small (below 0.14)
  /// that D1 would become negative.
  static MooneyRivlin from_lame(LameConstants k) {
    const double C2 = std::min(0.1 * k.mu, 0.25 * k.lambda);
    return {.C1 = 0.5 * k.mu - C2, .C2 = C2, .D1 = 0.5 * k.lambda - 2.0 * C2};
  }
  [[nodiscard]] LameConstants lame() const {
    return {.lambda = 2.0 * D1 + 4.0 * C2, .mu = 2.0 * (C1 + C2)};
  }
};

template <class T>
PALPABLE_ALWAYS_INLINE T energy_density(const MooneyRivlin& law, const Deformation<T>& d) {
  const Tensor<T> C = transposed_product(d.F, d.F);
  const T I2 = 0.5 * (d.I1 * d.I1 - inner(C, C));
  const T ln_J = logarithm(d.J);
  return law.C1 * (d.I1 - 3.0 - 2.0 * ln_J) + law.C2 * (I2 - 3.0 - 4.0 * ln_J) +
         law.D1 * ln_J * ln_J;
}

/// P = 2 C1 (F - F^-T) + 2 C2 (I1 F - F C - 2 F^-T) + 2 D1 ln J F^-T, from dI1/dF = 2 F,
/// dI2/dF = 2 (I1 F - F C) and d(ln J)/dF = F^-T.
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> first_piola(const MooneyRivlin& law, const Deformation<T>& d) {
  const Tensor<T> C = transposed_product(d.F, d.F);
  return (2.0 * law.C1) * (d.F - d.G) +
         (2.0 * law.C2) * (d.I1 * d.F - product(d.F, C) - 2.0 * d.G) +
         T(2.0 * law.D1 * logarithm(d.J)) * d.G;
}

/// With G = F^-T, dG = -G dF^T G and dC = dF^T F + F^T dF:
///
///     dP = 2 (C1 + C2 I1) dF + 4 C2 (F : dF) F - 2 C2 (dF C + F dC)
///          + (2 C1 + 4 C2 - 2 D1 ln J) G dF^T G + 2 D1 (G : dF) G
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> first_piola_along(const MooneyRivlin& law, const Deformation<T>& d,
                                                   const Tensor<T>& dF) {
  const Tensor<T> C = transposed_product(d.F, d.F);
  const Tensor<T> half = transposed_product(d.F, dF);
  Tensor<T> dC;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) dC(i, j) = half(i, j) + half(j, i);
  }
  const T on_dF = 2.0 * law.C1 + 2.0 * law.C2 * d.I1;
  const T on_F = 4.0 * law.C2 * inner(d.F, dF);
  const T swap = 2.0 * law.C1 + 4.0 * law.C2 - 2.0 * law.D1 * logarithm(d.J);
  const T on_G = 2.0 * law.D1 * inner(d.G, dF);
  return on_dF * dF + on_F * d.F + swap * swapped(d.G, dF) + on_G * d.G -
         (2.0 * law.C2) * (product(dF, C) + product(d.F, dC));
}

}  // namespace palpable
