/// @file
/// The linear complementarity problem of unilateral contact: which points press, and how hard.
///
///   m  contact points     W  compliance, (m x m) m/N     q  gap without forces, m     f  forces, N
///
///     g = W f + q >= 0,     f >= 0,     g_i f_i = 0
///
/// which is the minimum of 1/2 f W f + q f over f >= 0. With W positive definite there is exactly
/// one solution.
#pragma once

#include <span>
#include <vector>

namespace palpable {

/// Keeps the memory of its solves.
class Complementarity {
 public:
  /// @param most  contact points of one problem
  explicit Complementarity(int most);

  /// Block principal pivoting (Judice and Pires, Comput. Oper. Res. 21, 1994): all points that pull
  /// or enter change sides together, or one at a time (Murty) where that does not help. Starts with
  /// the points whose f is above 0 on entry. Allocates nothing.
  ///
  /// @param W  (m x m) row by row, symmetric positive definite; the lower triangle is read
  /// @param q  (m)
  /// @param f  (m) in: a guess; out: the solution
  /// @return whether it converged; else f is the best known, 0 where it would pull, and 0
  ///         everywhere if W is not positive definite
  /// @throws ContractViolation for more points than the constructor was given
  bool solve(std::span<const double> W, std::span<const double> q, std::span<double> f);

  [[nodiscard]] int steps() const { return steps_; }  ///< factorisations of the last solve

 private:
  bool solve_pressing(std::span<const double> W, std::span<const double> q);
  double gap(std::span<const double> W, std::span<const double> q, int i) const;

  int most_;
  int steps_ = 0;
  std::vector<int> pressing_;                // points that press now, in rising order
  std::vector<char> presses_;                // (m) 1: it presses now
  std::vector<double> factor_, f_, column_;  // of the pressing points; (m); scratch
};

}  // namespace palpable
