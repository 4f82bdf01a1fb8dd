/// @file
/// Vectors in 16 bits a number, for code whose run time is that of reading many vectors.
///
/// A vector is a step times integers of at most 32767. All its entries are thus rounded by the same
/// amount; for the largest entries that is far less than with bfloat16, which has 8 bits.
#pragma once

#include "palpable/common/material/simd.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

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

}  // namespace palpable
