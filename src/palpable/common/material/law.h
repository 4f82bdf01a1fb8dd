/// @file
/// How to write a law of hyperelasticity: a struct of its constants, with the law's name (kName),
/// the constants' names (kConstants) and the conversion from and to Lame's constants (from_lame(),
/// lame()), and three templates over the number type T,
///
///   T energy_density(const Law&, const Deformation<T>&)                        Psi, J/m^3
///   Tensor<T> first_piola(const Law&, const Deformation<T>&)                   P = dPsi/dF, Pa
///   Tensor<T> first_piola_along(const Law&, const Deformation<T>&, dF)         dP/dF : dF, Pa
///
/// for J > 0. T is double (this header turns them into functions of a matrix F) or a pack of eight
/// doubles (element_kernels.cpp). A law is registered by listing it in Material (material.h).
///
/// A law knows the present F alone. A law with a memory (damage, viscosity, plasticity) needs more:
/// internal variables at each integration point, which no interface has. In the bake they would
/// belong beside ElementBlock (solid/element_kernels.h), be kept when a step of solid/walk.h is
/// accepted, and end the assumption of that file and of the load paths that a state depends on its
/// load alone; the tables of touch would need them as a parameter, and the live half a state in
/// TouchState (response/touch_state.h). The live half uses laws for stress only: stiffness is baked
/// into the tables.
#pragma once

#include "palpable/common/base/contract.h"
#include "palpable/common/material/tensor.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <limits>

namespace palpable {

/// One constant of a law, named as in the law's formula.
struct LawConstant {
  const char* name;
  bool per_pressure = false;  ///< 1/Pa instead of Pa
  bool may_be_zero = false;   ///< 0 is allowed; negative values never are
};

/// Small-strain constants, Pa.
struct LameConstants {
  double lambda;
  double mu;
};

/// The quantities of a deformation that the laws use.
template <class T>
struct Deformation {
  Tensor<T> F;  ///< deformation gradient, dx/dX
  Tensor<T> G;  ///< F^-T, the derivative of ln J
  T J;          ///< det F, volume ratio; J <= 0 is an inverted element
  T I1;         ///< F : F
};

template <class T>
PALPABLE_ALWAYS_INLINE Deformation<T> deformation(const Tensor<T>& F) {
  Deformation<T> d;
  d.F = F;
  const Tensor<T> cofactor = cofactors(F);
  d.J = F(0, 0) * cofactor(0, 0) + F(1, 0) * cofactor(1, 0) + F(2, 0) * cofactor(2, 0);
  d.G = (1.0 / d.J) * cofactor;
  d.I1 = inner(F, F);
  return d;
}

/// G dF^T G = -dG, the change of F^-T.
template <class T>
PALPABLE_ALWAYS_INLINE Tensor<T> swapped(const Tensor<T>& G, const Tensor<T>& dF) {
  return product(G, transposed_product(dF, G));
}

/// dP/dF, Pa. P and F are read column by column, as Eigen stores them:
///
///     A(i + 3 J, k + 3 L) = dP_iJ / dF_kL
///
/// so that the 3 x 3 block (J, L) acts between the directions J and L of the undeformed body.
/// Symmetric, because P = dPsi/dF.
using Tangent = Eigen::Matrix<double, 9, 9>;

namespace detail {
inline Tensor<double> tensor_of(const Eigen::Matrix3d& F) {
  Tensor<double> tensor;
  std::copy_n(F.data(), 9, tensor.m);
  return tensor;
}
}  // namespace detail

/// Psi(F), energy per undeformed volume in J/m^3. It is infinite for J <= 0, so that a line search
/// shortens a step that inverts an element.
template <class Law>
[[nodiscard]] double energy_density(const Law& law, const Eigen::Matrix3d& F) {
  const Deformation<double> d = deformation(detail::tensor_of(F));
  return d.J > 0.0 ? energy_density(law, d) : std::numeric_limits<double>::infinity();
}

/// P(F) in Pa. @throws ContractViolation if J <= 0, where there is no stress.
template <class Law>
[[nodiscard]] Eigen::Matrix3d first_piola(const Law& law, const Eigen::Matrix3d& F) {
  const Deformation<double> d = deformation(detail::tensor_of(F));
  PALPABLE_EXPECT(d.J > 0.0, "an inverted element has no stress");
  return Eigen::Map<const Eigen::Matrix3d>(first_piola(law, d).m);
}

/// dP/dF in Pa. @throws ContractViolation if J <= 0.
template <class Law>
[[nodiscard]] Tangent tangent(const Law& law, const Eigen::Matrix3d& F) {
  const Deformation<double> d = deformation(detail::tensor_of(F));
  PALPABLE_EXPECT(d.J > 0.0, "an inverted element has no stress");
  Tangent A;
  for (int k = 0; k < 9; ++k) {
    Tensor<double> dF{};
    dF.m[k] = 1.0;
    A.col(k) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(first_piola_along(law, d, dF).m);
  }
  return A;
}

}  // namespace palpable
