/// @file
/// The linearised problem of unilateral contact with Coulomb's friction: which points press, which
/// of them slide, and their forces.
///
///   m  contact points      k  those with friction      f  (m) normal forces, N
///   t  (2k) friction, two tangential components a point, N      mu  (k) Coulomb's coefficients
///
///     g = W f + W_nt t + q >= 0,      f >= 0,      g_i f_i = 0
///     s = W_nt^T f + W_tt t + q_t,    |t_i| <= mu_i f_i,   and where less: s_i = 0,
///                                     else s_i = -z t_i with z >= 0
///
/// W and W_tt include the local compliance of the skin, which regularises both. Rounds of two
/// halves solve it: the linear complementarity problem of f for a given t (complementarity.h), and
/// Gauss-Seidel over the points for t with the bounds mu f. On a half space with a Poisson's ratio
/// of 0.4 a round reduces the residual to a tenth or less, since normal and tangential forces are
/// coupled weakly; with a ratio of 0 and mu of 1 or 3, to a third. After the first round a few
/// steps of Newton's method follow (Alart and Curnier 1991), if the points are few enough for a
/// frame's time: two of them take as long as a round of some tens of points, and most problems are
/// then solved. What is left is done by more rounds, as long as these help.
#pragma once

#include "palpable/common/contact/complementarity.h"

#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

struct ConeProblem {
  std::span<const double> W;    ///< (m x m) m/N, row by row; the lower triangle is read
  std::span<const double> q;    ///< (m) m
  std::span<const float> W_nt;  ///< (m x wide) m/N, rows padded to `wide` >= 2k
  std::size_t wide = 0;
  std::span<const double> W_tt;           ///< (2k x 2k) m/N, symmetric positive definite
  std::span<const double> q_t;            ///< (2k) m
  std::span<const std::size_t> contacts;  ///< (k) of the m, rising
  std::span<const double> mu;             ///< (k) >= 0
  double tolerance = 0;                   ///< m, of the natural residual
};

struct ConeOutcome {
  bool is_solved =
      false;  ///< false: the normal problem has no solution; f and t are not to be used
  /// m, the largest natural residual of a point: |min(g, W_ii f)|, and |t - P(t - s / w)| w with P
  /// the projection onto the disc of radius mu f and w the larger of the two W_tt of the point.
  double residual = 0;
  int rounds = 0;
  int newton_steps = 0;  ///< of Alart and Curnier's method; 0: the first round was enough
};

/// Keeps the memory of its solves. Allocates in make_room() alone.
class CoulombCone {
 public:
  /// @param most  contact points of one problem
  void make_room(std::size_t most);
  [[nodiscard]] bool has_room() const { return most_ > 0; }

  /// @param normal  solver of the normal problem, for as many points
  /// @param f, t    in: a guess; out: the solution
  ConeOutcome solve(const ConeProblem& problem, Complementarity& normal, std::span<double> f,
                    std::span<double> t);

  /// Rounds alone, and Newton's method alone, from the guess in f and t: the tests compare both.
  ConeOutcome solve_by_rounds(const ConeProblem& problem, Complementarity& normal,
                              std::span<double> f, std::span<double> t, int most_rounds);
  /// @param most_steps  of it
  ConeOutcome solve_by_newton(const ConeProblem& problem, std::span<double> f, std::span<double> t,
                              int most_steps);

  /// As ConeOutcome::residual.
  double residual(const ConeProblem& problem, std::span<const double> f, std::span<const double> t);

 private:
  void keep(std::span<const double> f, std::span<const double> t);
  void take_back(std::span<double> f, std::span<double> t) const;
  void add_friction(const ConeProblem& p, std::span<const double> t);
  void add_pressing(const ConeProblem& p, std::span<const double> f);
  void sweep(const ConeProblem& p, std::span<const double> f, std::span<double> t);
  bool newton_step(const ConeProblem& p, std::span<double> f, std::span<double> t);
  void fill_row(const ConeProblem& p, std::size_t contact, double factor, double* row) const;
  void fill_slip_row(const ConeProblem& p, std::size_t component, double factor, double* row) const;

  std::size_t most_ = 0;
  std::vector<double> q_, b_;               // (m) q + W_nt t, (2k) q_t + W_nt^T f
  std::vector<double> slip_, gap_;          // (2k), (m)
  std::vector<double> best_f_, best_t_;     // by keep()
  std::vector<double> matrix_, right_;      // of a step of it
  std::vector<int> column_of_, columns_t_;  // (m), (k) of its unknowns; -1: none
};

}  // namespace palpable
