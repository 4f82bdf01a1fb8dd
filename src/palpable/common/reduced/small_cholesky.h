/// @file
/// Cholesky factorisation for some dozens of unknowns, column by column. It does not allocate, as a
/// library might.
///
///   n  unknowns     L  lower triangle, L L^T = A
#pragma once

#include <Eigen/Core>

#include <cmath>

namespace palpable {

/// A <- L in its lower triangle; false if A is not positive definite.
/// @param A  (n x n) the lower triangle is read
[[nodiscard]] inline bool factorise_small(Eigen::MatrixXd& A) {
  const Eigen::Index n = A.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index k = 0; k < j; ++k) A.col(j).tail(n - j) -= A(j, k) * A.col(k).tail(n - j);
    if (!(A(j, j) > 0.0)) return false;
    A.col(j).tail(n - j) /= std::sqrt(A(j, j));
  }
  return true;
}

/// x <- L^-1 x. @param x  (n)
inline void solve_lower(const Eigen::MatrixXd& L, Eigen::Ref<Eigen::VectorXd> x) {
  const Eigen::Index n = L.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    x[j] /= L(j, j);
    x.tail(n - j - 1) -= x[j] * L.col(j).tail(n - j - 1);
  }
}

/// x <- L^-T x. @param x  (n)
inline void solve_upper(const Eigen::MatrixXd& L, Eigen::Ref<Eigen::VectorXd> x) {
  const Eigen::Index n = L.rows();
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    x[j] -= L.col(j).tail(n - j - 1).dot(x.tail(n - j - 1));
    x[j] /= L(j, j);
  }
}

}  // namespace palpable
