/// @file
/// Intrusive PGD of a nonlinear body over positions x load size: modes F_i(x) G_i(s, a) of the
/// power series of all positions (SeriesTable).
///
///   N  nodes   S  positions   n_s  orders of position s   J  load sizes   m  modes
///
///     u(x, s, a) = sum_p c_p(s, a) u_p(x, s)  ~=  sum_i F_i(x) G_i(s, a),   K u_p(s) = r_p(s),
///     G_i(s, a) = sum_p c_p(s, a) G_i,p(s)
///
/// Alternating directions, each step on the weak form of the orders:
///
///     x-step   F = K^-1 sum_s omega_s sum_{p,q} g_p(s) W_pq(s) r_q(s),   made normal to F_1 ...
///     s-step   g_p(s) = z . r_p(s),   K z = M F    (the adjoint: best in L2)
///
/// with W_pq = mean over the load sizes of c_p c_q. One basis serves all orders. The right-hand
/// sides r_p are those of the full fields; with orders below p truncated by a basis, r_p would
/// contain spurious membrane forces. For p >= 2 K^-1 r_p is the u_p that the table holds, and
/// both half steps use it: the same numbers for no solve. For p = 1 they are solves.
#pragma once

#include "palpable/bake/solid/load_series.h"
#include "palpable/common/base/progress.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <functional>
#include <vector>

namespace palpable {

/// Power series of one body under a load at each of many positions: what the intrusive PGD of the
/// nonlinear beam separates.
///
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

/// Weight of a position and a load size in the error.
enum class SeriesWeight {
  kPlain,   ///< its area: the small fields at the root of a beam then hardly count
  kOwnNorm  ///< its area over |u_1(s)|^2 a^2: errors are relative to each field's own norm
};

struct SeriesPgdGoal {
  SeriesWeight weight = SeriesWeight::kOwnNorm;
  int modes = 32;        ///< at most
  double tolerance = 0;  ///< fewer modes, once the relative error in that weight is below
  /// Flags of the positions that are used; G is 0 at the others. Empty: all.
  std::vector<char> used = {};
};

struct SeriesPgd {
  Eigen::MatrixXd F;               ///< (3N x m) orthonormal in L2
  std::vector<Eigen::MatrixXd> G;  ///< (S) of (m x n_s): G_i,p(s); m
  Eigen::VectorXd errors;          ///< (m) relative, in the goal's weight, after 1, 2, ... modes
  int alternations = 0;            ///< of all modes
};

[[nodiscard]] SeriesPgd series_pgd(const LoadSeries& body, const SeriesTable& table,
                                   const SeriesPgdGoal& goal, const Progress& progress = {});

/// The best `modes` modes that the span of pgd.F has for the weight: an SVD of its coordinates.
/// `errors` are those after 1, 2, ... of them, of the table itself.
[[nodiscard]] SeriesPgd recompressed(const SeriesPgd& pgd, const SeriesTable& table,
                                     const SeriesPgdGoal& goal, int modes);

/// The SVD of all fields of the table in the goal's weight, by subspace iteration: goal.modes
/// modes, computed independently of the greedy ones. For comparison: it takes longer than they do.
[[nodiscard]] SeriesPgd svd_of_series(const LoadSeries& body, const SeriesTable& table,
                                      const SeriesPgdGoal& goal, const Progress& progress = {});

/// (S) of (m x n_s): F_i . M u_p(s), the best coordinates of all positions in any modes, also those
/// of other positions.
/// @param F  (3N x m) orthonormal in L2
[[nodiscard]] std::vector<Eigen::MatrixXd> coordinates_of(const LoadSeries& body,
                                                          const SeriesTable& table,
                                                          const Eigen::MatrixXd& F);

/// Errors of the first `modes` modes against the fields of the table.
struct SeriesErrors {
  double global = 0;  ///< relative, over all positions and load sizes together, by area
  double worst = 0;   ///< of one position and load size, in its own norm
  Eigen::VectorXd worst_of_position = {};  ///< (S) the same for each
};

}  // namespace palpable
