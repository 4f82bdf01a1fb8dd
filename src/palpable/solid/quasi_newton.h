/// @file
/// A factor of an older tangent that learns from the solves it is used in.
///
/// Conjugate gradients with a tangent K leave pairs (s, K s). A limited-memory BFGS update carries
/// the factor's inverse over to one that is exact on the last of them (Morales and Nocedal,
/// "Automatic preconditioning by limited memory quasi-Newton updating", SIAM J. Optim. 10, 2000).
/// From one load level to the next the tangent changes little, and what differs from the factor is
/// a few directions about the pressed patch and the thin parts that turn. On a site at a bunny's
/// ear (16,044 nodes, 26 levels) a path with the factor of the undeformed body took 784 iterations
/// without pairs, 359 with 16, 248 with 32 and 206 with 64.
#pragma once

#include "palpable/solid/conjugate_gradients.h"

#include <Eigen/Core>

#include <deque>

namespace palpable {

class QuasiNewton {
 public:
  /// @param capacity  how many pairs are kept, 8 bytes each per unknown and pair; a solve reads
  ///                  them twice
  explicit QuasiNewton(int capacity = 32) : capacity_(capacity) {}

  /// x ~= K^-1 b, symmetric and positive definite whatever was learnt.
  /// @param apply_factor  x ~= inverse of the older tangent times b
  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x, const LinearMap& apply_factor);

  /// A direction s and K s, noted for the next system: the current one's preconditioner must not
  /// change under conjugate gradients. @pre s . Ks > 0
  void note(const Eigen::VectorXd& s, const Eigen::VectorXd& Ks);

  /// Takes what was noted into use, the newest instead of the oldest.
  void learn();

 private:
  struct Pair {
    Eigen::VectorXf s, y;  // y = K s
    double inverse_curvature = 0;
  };

  int capacity_;
  std::deque<Pair> pairs_, noted_;  // oldest first
  std::deque<Pair> spare_;          // memory to use again
  std::vector<double> shares_;
  Eigen::VectorXf q_, z_;
  Eigen::VectorXd wide_;
};

}  // namespace palpable
