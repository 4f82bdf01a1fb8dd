/// @file
/// Coefficients of the stored energy of a St. Venant-Kirchhoff body in some modes, and modes in
/// which its equilibrium can be sought.
///
///   N  nodes     n  modes
#pragma once

#include "palpable/bake/solid/load_series.h"
#include "palpable/common/reduced/quartic_energy.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace palpable {

/// With e_i = sym grad F_i and g_ij = sym (grad F_i)^T grad F_j, Green's strain is
/// sum q_i e_i + 1/2 sum q_i q_j g_ij, and with <A, B> = integral of A : C : B
///
///     K_ij = <e_i, e_j>,   C_ijk = <e_i, g_jk> + <e_j, g_ik> + <e_k, g_ij>,
///     D_ijkl = <g_ij, g_kl> + <g_ik, g_jl> + <g_il, g_jk>
///
/// exactly, from the Gram matrix of all e and g. Costs 7 E (n + n (n + 1) / 2)^2 operations.
/// @param F  (3N x n) m
[[nodiscard]] QuarticEnergy quartic_energy(const SolidModel& model, const Eigen::MatrixXd& F);

/// (3N x n) modes, orthonormal in L2: the first `linear` modes of the linear responses to the
/// loads, each response scaled to unit length (fewer, where the responses are linearly dependent);
/// and the second-order responses to the first `curved` of these and to their pairs (modal
/// derivatives, Idelsohn and Cardona 1985). Without the latter a beam could not bend without
/// stretching: with modes that are best in L2 alone, Galerkin's method locks.
/// @param loads   (3N x S) N, of the size that they will have
[[nodiscard]] Eigen::MatrixXd energy_modes(const LoadSeries& body,
                                           const Eigen::SparseMatrix<double>& loads, int linear,
                                           int curved);

}  // namespace palpable
