/// @file
/// Intrusive PGD of a nonlinear body over positions x load size: modes F_i(x) G_i(s, a) of the
/// power series of all positions (series_table.h).
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

#include "palpable/bake/intrusive/series_table.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

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
