/// @file
/// The exact stored energy of a St. Venant-Kirchhoff body in a few modes, and the body's
/// equilibrium in these modes under any load.
///
///   n  modes     P  pairs (i, j) with i <= j, n (n + 1) / 2, in the order 00 01 11 02 12 22 ...
///
///     u = sum_i q_i F_i,     W(q) = 1/2 K qq + 1/6 C qqq + 1/24 D qqqq
///
/// Green's strain is quadratic in u and the energy is quadratic in the strain, so this polynomial
/// is exact.
#pragma once

#include <Eigen/Core>

namespace palpable {

/// Coefficients; C and D are symmetric under any exchange of indices.
struct QuarticEnergy {
  Eigen::VectorXd K;  ///< (P) J, K_ij
  Eigen::MatrixXd C;  ///< (P x n) J, C_ijk at row (i, j)
  Eigen::MatrixXd D;  ///< (P x P) J, D_ijkl at row (i, j), column (k, l)

  [[nodiscard]] int modes() const { return static_cast<int>(C.cols()); }
};

/// Row of the pair (i, j), in either order.
[[nodiscard]] inline Eigen::Index pair_row(Eigen::Index i, Eigen::Index j) {
  return i <= j ? j * (j + 1) / 2 + i : i * (i + 1) / 2 + j;
}

/// The distinct coefficients, which a body file holds: those with i <= j <= k <= l, ordered with
/// the last index running slowest.
struct DistinctCoefficients {
  Eigen::VectorXd quadratic;  ///< (n (n + 1) / 2) J, K_ij: 00 01 11 02 12 22 ...
  Eigen::VectorXd cubic;      ///< (n (n + 1) (n + 2) / 6) J, C_ijk: 000 001 011 111 002 ...
  Eigen::VectorXd quartic;    ///< (n (n + 1) (n + 2) (n + 3) / 24) J, D_ijkl
};
[[nodiscard]] DistinctCoefficients distinct_coefficients(const QuarticEnergy& energy);

/// The inverse of distinct_coefficients(). @pre the sizes are those of n = `modes` modes
[[nodiscard]] QuarticEnergy energy_of(int modes, const DistinctCoefficients& coefficients);

/// Number of distinct coefficients of a symmetric form with `order` indices in 0 .. n - 1:
/// n (n + 1) ... (n + order - 1) / order!.
[[nodiscard]] constexpr Eigen::Index distinct_count(Eigen::Index n, int order) {
  Eigen::Index count = 1;
  for (int k = 0; k < order; ++k) count = count * (n + k) / (k + 1);
  return count;
}

/// Newton's method on dW/dq = f, from any start. Only the constructor allocates.
class QuarticEquilibrium {
 public:
  /// @param energy  outlives this; its values are finite and K is positive definite
  explicit QuarticEquilibrium(const QuarticEnergy& energy);

  struct Answer {
    bool converged = false;  ///< |dW/dq - f| <= 1e-6 |f|; otherwise q is the last iterate
    int steps = 0;           ///< of Newton's method
    double residual = 0;     ///< relative to |f|
  };
  /// Steps that raise W - f . q are halved; if the second derivative is not positive definite, a
  /// multiple of the diagonal of K is added to it. A step takes 0.1 ms with two dozen modes.
  /// @param f  (n) N m per unit of q: F_i . forces
  /// @param q  (n) in: where to start; out: the equilibrium
  Answer solve(const Eigen::VectorXd& f, Eigen::VectorXd& q);

  /// Returns W and stores its first and second derivative in gradient() and hessian().
  double evaluate(const Eigen::VectorXd& q);
  [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }
  [[nodiscard]] const Eigen::MatrixXd& hessian() const { return hessian_; }

 private:
  // Stores the step (H + shift diag K)^-1 r in step_; false if that matrix is not positive
  // definite.
  bool newton_step(double shift);

  const QuarticEnergy& energy_;
  Eigen::VectorXd products_, of_pairs_, quartic_, cubic_;  // (P)
  Eigen::MatrixXd hessian_, factor_;                       // (n x n)
  Eigen::VectorXd gradient_, right_, step_, trial_;        // (n)
};

}  // namespace palpable
