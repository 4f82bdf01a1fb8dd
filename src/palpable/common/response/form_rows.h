/// @file
/// Symmetric forms laid out for evaluation: long rows over pairs of indices, which suit vector
/// instructions.
///
///   n  variables      p  pairs i <= j, ordered by i, then j: n (n + 1) / 2, padded to a multiple
///                        of 16 with zeros
///
///     cubic      n rows: row i has A_ijk for all pairs (j, k)
///     quartic    one row for each pair (i, j), with E_ijkl for all pairs (k, l)
///
/// This layout has three to six times as many numbers as a body file stores (symmetric_form.h), and
/// is ten times as fast.
#pragma once

#include "palpable/common/response/rounded_rows.h"
#include "palpable/common/response/symmetric_form.h"

#include <cstddef>
#include <span>

namespace palpable {

/// The number p of pairs of n variables, padded.
[[nodiscard]] std::size_t pair_width(int variables);

/// Only the constructor allocates.
class FormRows {
 public:
  FormRows() = default;  ///< a form without variables
  explicit FormRows(const SymmetricForm& form);

  [[nodiscard]] int variables() const { return variables_; }
  [[nodiscard]] std::size_t width() const { return rows_.width; }  ///< p

  /// pairs += factor A(a, ., .) of a cubic form. @param a  (n)  @param pairs  (p)
  void add_cubic(std::span<const float> a, float factor, std::span<float> pairs) const;
  /// The form with two of its arguments replaced by a symmetric matrix P: (n) sum_jk A_ijk P_jk of
  /// a cubic form, (p) sum_kl E_ijkl P_kl at the pairs (i, j) of a quartic one.
  /// @param P       (p) as add_pairs() lays it out
  void contract(std::span<const float> P, std::span<float> result) const;

 private:
  int variables_ = 0;
  RoundedRows rows_;
};

/// P += factor a a^T, off-diagonal entries doubled: the layout that contract() expects.
/// @param P  (p)
void add_pairs(std::span<const float> a, float factor, std::span<float> P);

/// matrix += pairs, symmetrically.
/// @param stride  of the matrix's rows, >= n
void add_to_matrix(std::span<const float> pairs, int n, std::size_t stride,
                   std::span<float> matrix);

}  // namespace palpable
