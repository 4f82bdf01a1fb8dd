/// @file
/// Vectors in 16 bits a number, for what reads many of them and is bound by memory.
///
/// Each is one step times integers of at most 32767, so that all its entries are rounded by the
/// same amount: a tenth of what the 8 bits of a bfloat16 would do to the largest ones.
#pragma once

#include "palpable/solid/simd.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

class RoundedVector {
 public:
  /// Becomes v, each entry within max |v| / 65534. v is finite; zero stays zero.
  void assign(const Eigen::VectorXd& v);

  /// v . w, without further rounding. @pre of one size
  [[nodiscard]] double dot(const RoundedVector& w) const;

  /// How many numbers a vector of floats must have room for that kernels below work on: its size,
  /// and zeros behind.
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
/// @param q  of v's padded size, zeros behind
[[nodiscard]] float dot(SimdLevel simd, const RoundedVector& v, const Eigen::VectorXf& q);

/// q += share v, then w . q, in one pass.
/// @param q  of the padded size of v and w, zeros behind
[[nodiscard]] float add_then_dot(SimdLevel simd, float share, const RoundedVector& v,
                                 Eigen::VectorXf& q, const RoundedVector& w);

}  // namespace palpable
