/// @file
/// Neo-Hookean solid in the form of Abaqus and CalculiX (*HYPERELASTIC, NEO HOOKE), for comparing
/// with them; the paper's bodies were computed by Abaqus.
///
///   F      deformation gradient, dx/dX                 (3 x 3)
///   J      det F, volume ratio; J <= 0 is an inverted element
///   I1bar  J^(-2/3) tr(F^T F), which does not change with volume
///   P      first Piola-Kirchhoff stress, dPsi/dF       (3 x 3) Pa
#pragma once

#include "palpable/common/material/law.h"

namespace palpable {

/// Psi(F) = C10 (I1bar - 3) + (J - 1)^2 / D1
///
/// Unlike eq. (7) this separates shape from volume: the first term resists a change of shape, the
/// second a change of volume. As J -> 0 the second term stays finite, and so does its pressure
/// 2 (1 - J) / D1. The factor J^(-2/3) of the first grows without bound, so a crushed element still
/// stiffens, unless it is compressed equally in all directions.
///
/// For small strains this is linear elasticity with shear modulus mu = 2 C10 and bulk modulus
/// kappa = 2 / D1, so lambda = kappa - 2/3 mu.
struct NeoHookeanAbaqus {
  double C10;  ///< Pa, > 0
  double D1;   ///< 1/Pa, > 0; not D1 of eq. (7), which is a modulus in Pa

  static constexpr const char* kName = "neo-hooke-abaqus";
  static constexpr std::array kConstants{LawConstant{.name = "C10"},
                                         LawConstant{.name = "D1", .per_pressure = true}};
  static NeoHookeanAbaqus from_lame(LameConstants k) {
    return {.C10 = 0.5 * k.mu, .D1 = 2.0 / (k.lambda + 2.0 / 3.0 * k.mu)};
  }
  [[nodiscard]] LameConstants lame() const {
    return {.lambda = 2.0 / D1 - 4.0 / 3.0 * C10, .mu = 2.0 * C10};
  }
};

template <class T>
PALPABLE_ALWAYS_INLINE T energy_density(const NeoHookeanAbaqus& law, const Deformation<T>& d) {
  const T r = inverse_cube_root(d.J);
  return law.C10 * (r * r * d.I1 - 3.0) + (d.J - 1.0) * (d.J - 1.0) * (1.0 / law.D1);
}

/// P = a (F - I1/3 F^-T) + b F^-T with a = 2 C10 J^(-2/3) and b = 2/D1 (J - 1) J, from
/// dI1/dF = 2 F and dJ/dF = J F^-T.
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> first_piola(const NeoHookeanAbaqus& law, const Deformation<T>& d) {
  const T r = inverse_cube_root(d.J);
  const T a = 2.0 * law.C10 * r * r;
  const T b = (2.0 / law.D1) * (d.J - 1.0) * d.J;
  return a * d.F + T(b - a * d.I1 * (1.0 / 3.0)) * d.G;
}

/// With G = F^-T, dG = -G dF^T G and da = -2/3 a (G : dF):
///
///     dP = a dF - 2/3 a ((G : dF) F + (F : dF) G) + (a I1/3 - b) G dF^T G
///          + (2/9 a I1 + 2/D1 (2 J - 1) J) (G : dF) G
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> first_piola_along(const NeoHookeanAbaqus& law,
                                                   const Deformation<T>& d, const Tensor<T>& dF) {
  const T r = inverse_cube_root(d.J);
  const T a = 2.0 * law.C10 * r * r;
  const T swap = a * d.I1 * (1.0 / 3.0) - (2.0 / law.D1) * (d.J - 1.0) * d.J;
  const T straight = (2.0 / 9.0) * a * d.I1 + (2.0 / law.D1) * (2.0 * d.J - 1.0) * d.J;
  const T G_dF = inner(d.G, dF);
  const T mixed = (-2.0 / 3.0) * a;
  return a * dF + T(mixed * G_dF) * d.F + T(mixed * inner(d.F, dF) + straight * G_dF) * d.G +
         swap * swapped(d.G, dF);
}

}  // namespace palpable
