/// @file
/// St. Venant-Kirchhoff solid: Hooke's law between Green's strain and the second Piola stress.
///
///   F    deformation gradient, dx/dX                 (3 x 3)
///   E    Green's strain, (F^T F - I) / 2             (3 x 3)
///   S    second Piola-Kirchhoff stress, dPsi/dE      (3 x 3) Pa
///   P    first Piola-Kirchhoff stress, F S           (3 x 3) Pa
#pragma once

#include "palpable/common/material/law.h"

namespace palpable {

/// Psi(F) = lambda/2 (tr E)^2 + mu E : E
///
/// The textbook law for large rotations and small strains. It softens in strong compression: when a
/// bar is compressed below 1/sqrt(3) = 0.58 of its length (uniaxial strain), the force falls the
/// shorter it gets, and the energy stays finite when an element is inverted. So loads must be
/// bounded, and an equilibrium path ends where the body collapses.
struct SaintVenantKirchhoff {
  double lambda;  ///< Pa, >= 0
  double mu;      ///< Pa, > 0

  static constexpr const char* kName = "saint-venant-kirchhoff";
  static constexpr std::array kConstants{LawConstant{.name = "lambda", .may_be_zero = true},
                                         LawConstant{.name = "mu"}};
  static SaintVenantKirchhoff from_lame(LameConstants k) { return {k.lambda, k.mu}; }
  [[nodiscard]] LameConstants lame() const { return {lambda, mu}; }
};

namespace detail {
// E = (F^T F - I) / 2
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> green_strain(const Tensor<T>& F) {
  Tensor<T> E = 0.5 * transposed_product(F, F);
  for (int i = 0; i < 3; ++i) E(i, i) -= 0.5;
  return E;
}

// lambda tr E I + 2 mu E
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> hooke(const SaintVenantKirchhoff& law, const Tensor<T>& E) {
  Tensor<T> S = (2.0 * law.mu) * E;
  const T pressure = law.lambda * trace(E);
  for (int i = 0; i < 3; ++i) S(i, i) += pressure;
  return S;
}
}  // namespace detail

template <class T>
PALPABLE_ALWAYS_INLINE T energy_density(const SaintVenantKirchhoff& law, const Deformation<T>& d) {
  const Tensor<T> E = detail::green_strain(d.F);
  const T trace_E = trace(E);
  return 0.5 * law.lambda * trace_E * trace_E + law.mu * inner(E, E);
}

/// P = F S
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> first_piola(const SaintVenantKirchhoff& law,
                                             const Deformation<T>& d) {
  return product(d.F, detail::hooke(law, detail::green_strain(d.F)));
}

/// dP = dF S + F dS, where dS follows from dE = (dF^T F + F^T dF) / 2 as S from E.
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> first_piola_along(const SaintVenantKirchhoff& law,
                                                   const Deformation<T>& d, const Tensor<T>& dF) {
  const Tensor<T> half = transposed_product(d.F, dF);
  Tensor<T> dE;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) dE(i, j) = 0.5 * (half(i, j) + half(j, i));
  }
  return product(dF, detail::hooke(law, detail::green_strain(d.F))) +
         product(d.F, detail::hooke(law, dE));
}

}  // namespace palpable
