/// @file
/// Intrusive PGD of a linear body whose load travels (paper eqs. 4-6): u(x, s) = sum F_i(x) G_i(s)
/// from the weak form; no position's own solution is computed.
///
///   N  nodes     S  positions     m  modes
///
///     sum_s w_s  v(x) h(s) . (K u(s) - f(s)) = 0        for all v(x) h(s)
///
/// by alternating directions: with G given, a solve with K; with F given, a formula.
#pragma once

#include "palpable/bake/solid/load_series.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace palpable {

/// How G is found when F is given.
enum class PositionStep {
  /// G(s) = F . f(s) / (F . K F): Galerkin's, the classical PGD. With the parameter in the load
  /// alone, its modes are those of the SVD in the energy norm. In that norm every local dent
  /// counts, so that the fields are of nearly full rank.
  kGalerkin,
  /// G(s) = z . f(s) with K z = M F, the adjoint: that is F . M u(s), exactly, and so the modes are
  /// those of the SVD in L2.
  kAdjoint
};

struct LinearPgd {
  Eigen::MatrixXd F;  ///< (3N x m) of unit length in L2 (kAdjoint) or in energy (kGalerkin)
  Eigen::MatrixXd G;  ///< (S x m)
  int solves = 0;     ///< with K
};

/// Greedy: each mode is fitted to the remainder that the previous modes leave, by at most 30
/// alternations, until G changes by less than 1 % of its norm.
/// @param loads    (3N x S) f(s), N; no column is zero
/// @param weights  (S) w_s > 0
/// @param modes    m, 1 .. S
[[nodiscard]] LinearPgd linear_pgd(const LoadSeries& body, const Eigen::SparseMatrix<double>& loads,
                                   const Eigen::VectorXd& weights, PositionStep step, int modes);

/// Errors of a separated field against the solutions of all positions, which are computed for this.
struct LinearErrors {
  Eigen::VectorXd l2;      ///< (m) relative error with 1 .. m modes, in L2
  Eigen::VectorXd energy;  ///< (m) the same in the energy norm, sqrt(u . K u)
};
[[nodiscard]] LinearErrors linear_errors(const LoadSeries& body,
                                         const Eigen::SparseMatrix<double>& loads,
                                         const Eigen::VectorXd& weights, const LinearPgd& pgd);

}  // namespace palpable
