/// @file
/// Power series of one body under a load at each of many positions: what the intrusive PGD of the
/// nonlinear beam separates.
///
///   N  nodes     S  positions     n_s  orders of position s     J  load sizes
#pragma once

#include "palpable/bake/solid/load_series.h"
#include "palpable/common/base/progress.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <functional>
#include <vector>

namespace palpable {

/// The orders of all positions. u_1 is not kept: it is K^-1 f(s), and the PGD makes its products
/// from f(s). Memory: 12 bytes a node, order and position.
struct SeriesTable {
  Eigen::SparseMatrix<double> load;     ///< (3N x S) f(s), N at the full load
  Eigen::VectorXd area;                 ///< (S) > 0: weights of the positions in integrals over s
  std::vector<Eigen::MatrixXf> higher;  ///< (S) of (3N x n_s - 1): u_2, u_3, ..., m
  std::vector<Eigen::MatrixXd> gram;    ///< (S) of (n_s x n_s): <u_p, u_q> in L2, m^2 m^3
  /// (S) of (n_s x J): coefficients of the orders at each load size. Those of the Pade form where
  /// that is the more accurate one (6 orders and more), else a^p.
  std::vector<Eigen::MatrixXd> at_level;
  std::vector<Eigen::VectorXd> work;  ///< (S) of (n_s): f(s) . u_p, J
  Eigen::VectorXd levels;             ///< (J) fractions of the full load, increasing, up to 1
  double worst_pade_gap = 0;          ///< largest |Pade - series| / |series| at the full load
  /// (J), or with ResidualsAt::kFullLoad (1): largest |internal_force(u) - a f| / |a f| of all
  /// positions, at the free nodes.
  Eigen::VectorXd worst_residual = {};
  double check_cpu_s = 0;           ///< CPU time of the residuals at all but the full load
  int most_orders = 0, orders = 0;  ///< of one position at most; of all together

  [[nodiscard]] Eigen::Index positions() const { return load.cols(); }
};

/// Receives the fields of position s, (3N x K) m at some fractions of the full load, while its
/// orders are in memory.
using SeriesVisit = std::function<void(Eigen::Index s, const Eigen::MatrixXd& fields)>;

/// Where solve_series() computes residual forces: at the full load, where they are largest, or at
/// all load sizes.
enum class ResidualsAt { kFullLoad, kAllLevels };

/// Solves the series of all positions, in the order of their distance from the supports, since
/// those farther away need more orders.
/// @param load    (3N x S) N; no column is zero
/// @param area    (S) > 0
/// @param levels  fractions of the full load at which fields are wanted, increasing, up to 1
/// @param shown   (K) the fractions at which `visit` receives the fields
/// @throws Error where a series does not converge, with the position and the load that it bears
[[nodiscard]] SeriesTable solve_series(const LoadSeries& body,
                                       const Eigen::SparseMatrix<double>& load,
                                       const Eigen::VectorXd& area, const Eigen::VectorXd& levels,
                                       const Eigen::VectorXd& shown = {},
                                       const SeriesVisit& visit = {}, const Progress& progress = {},
                                       ResidualsAt residuals = ResidualsAt::kFullLoad);

}  // namespace palpable
