/// @file
/// Corrects the factor of an older tangent by what solves with the present tangent have shown.
///
/// Conjugate gradients with a tangent K produce pairs (s, K s). A limited-memory BFGS update turns
/// the factor's inverse into one that is exact on the last pair (Morales and Nocedal, "Automatic
/// preconditioning by limited memory quasi-Newton updating", SIAM J. Optim. 10, 2000). This pays
/// because the tangent changes little from one load level to the next, and differs from the factor
/// in few directions: around the pressed patch and in thin parts that turn. On a site at a bunny's
/// ear (16,044 nodes, 26 levels) a path with the factor of the undeformed body took 784 iterations
/// without pairs, 359 with 16, 248 with 32 and 206 with 64.
///
/// Reading the pairs dominates the time of a solve, so they are kept in 16 bits a number: over
/// eight sites of the bunny that raised 1,586 iterations to 1,601 (bfloat16: 1,671). More than 24
/// pairs cost more time than they save, there (48: 1,589 iterations, 24: 1,628, 16: 1,683) and on
/// the dragon (six of its hardest sites; 64: 4,710, 24: 5,002).
#pragma once

#include "palpable/bake/solid/conjugate_gradients.h"
#include "palpable/common/material/simd.h"

#include <Eigen/Core>

#include <cstdint>
#include <deque>
#include <vector>

namespace palpable {

/// A vector in 16 bits a number, for code whose run time is that of reading many vectors. It is a
/// step times integers of at most 32767. All its entries are thus rounded by the same amount; for
/// the largest entries that is far less than with bfloat16, which has 8 bits.
class RoundedVector {
 public:
  /// Becomes v, each entry within max |v| / 65534. v is finite; zero stays zero.
  void assign(const Eigen::VectorXd& v);

  /// v . w of the rounded vectors, summed in double precision. @pre both have one size
  [[nodiscard]] double dot(const RoundedVector& w) const;

  /// The size that the float vectors of the functions below must have: this vector's size, rounded
  /// up to whole vector registers. The entries beyond are zero.
  [[nodiscard]] Eigen::Index padded_size() const {
    return static_cast<Eigen::Index>(integers_.size());
  }

 private:
  friend float dot(SimdLevel, const RoundedVector&, const Eigen::VectorXf&);
  friend float add_then_dot(SimdLevel, float, const RoundedVector&, Eigen::VectorXf&,
                            const RoundedVector&);

  std::vector<std::int16_t> integers_;
  float step_ = 0;
};

/// v . q
/// @param q  of v's padded size, zeros at the end
[[nodiscard]] float dot(SimdLevel simd, const RoundedVector& v, const Eigen::VectorXf& q);

/// q += share v, then w . q, in one pass.
/// @param q  of the padded size of v and w, zeros at the end
[[nodiscard]] float add_then_dot(SimdLevel simd, float share, const RoundedVector& v,
                                 Eigen::VectorXf& q, const RoundedVector& w);

class QuasiNewton {
 public:
  /// @param capacity  how many pairs are kept. A pair takes 4 bytes an unknown; a solve reads all
  ///                  pairs twice
  explicit QuasiNewton(int capacity = 24, SimdLevel simd = best_simd_level())
      : capacity_(capacity), simd_(simd) {}

  /// x ~= K^-1 b. The map from b to x is symmetric and positive definite whatever pairs are in use.
  /// @param apply_factor  x ~= K_old^-1 b, K_old the tangent that was factorised
  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x, const LinearMap& apply_factor);

  /// Keeps a direction s and K s for the systems after this one; solve() does not use the pair yet,
  /// because conjugate gradients need the same preconditioner throughout. @pre s . Ks > 0
  void record(const Eigen::VectorXd& s, const Eigen::VectorXd& Ks);

  /// From now on solve() uses the recorded pairs too; they replace the oldest.
  void use_recorded();

 private:
  struct Pair {
    RoundedVector s, y;  // y = K s
    double inverse_curvature = 0;
  };

  int capacity_;
  SimdLevel simd_;
  std::deque<Pair> pairs_, recorded_;  // oldest first
  std::deque<Pair> spare_;             // memory to use again
  std::vector<double> shares_;
  Eigen::VectorXf q_;
  Eigen::VectorXd wide_;
};

}  // namespace palpable
