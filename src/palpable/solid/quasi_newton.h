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
///
/// A solve is bound by the bytes of the pairs, so they are kept in 16 bits a number: over eight
/// sites of the bunny that made 1,601 iterations of 1,586; bfloat16 made 1,671. More than 24 pairs
/// cost more than they save there (48: 1,589 iterations, 24: 1,628, 16: 1,683) and on the dragon
/// (six of its hardest sites; 64: 4,710, 24: 5,002).
#pragma once

#include "palpable/solid/conjugate_gradients.h"
#include "palpable/solid/rounded_vector.h"
#include "palpable/solid/simd.h"

#include <Eigen/Core>

#include <deque>

namespace palpable {

class QuasiNewton {
 public:
  /// @param capacity  how many pairs are kept, 4 bytes each per unknown and pair; a solve reads
  ///                  them twice
  explicit QuasiNewton(int capacity = 24, SimdLevel simd = best_simd_level())
      : capacity_(capacity), simd_(simd) {}

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
    RoundedVector s, y;  // y = K s
    double inverse_curvature = 0;
  };

  int capacity_;
  SimdLevel simd_;
  std::deque<Pair> pairs_, noted_;  // oldest first
  std::deque<Pair> spare_;          // memory to use again
  std::vector<double> shares_;
  Eigen::VectorXf q_;
  Eigen::VectorXd wide_;
};

}  // namespace palpable
