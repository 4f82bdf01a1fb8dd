/// @file
/// Symmetric forms laid out to be multiplied with: long rows of pairs of indices, which vector
/// instructions go along.
///
///   n  variables      p  pairs i <= j, ordered by i, then j: n (n + 1) / 2, padded to a multiple
///                        of 16 with zeros
///
///     cubic      n rows: row i has A_ijk for all pairs (j, k)
///     quartic    one row for each pair (i, j), with E_ijkl for all pairs (k, l)
///
/// Three to six times the numbers that a body file keeps (symmetric_form.h), and ten times as fast.
#pragma once

#include "palpable/common/response/rounded_rows.h"
#include "palpable/common/response/symmetric_form.h"

#include <cstddef>
#include <span>

namespace palpable {

/// p of n variables.
[[nodiscard]] std::size_t pair_width(int variables);

/// Nothing here allocates but the constructor.
class FormRows {
 public:
  FormRows() = default;  ///< of no variables
  explicit FormRows(const SymmetricForm& form);

  [[nodiscard]] int variables() const { return variables_; }
  [[nodiscard]] std::size_t width() const { return rows_.width; }  ///< p

  /// pairs += factor A(a, ., .) of a cubic form. @param a  (n)  @param pairs  (p)
  void add_cubic(std::span<const float> a, float factor, std::span<float> pairs) const;
  /// The form with two places taken by a symmetric matrix P: for a cubic one (n) sum_jk A_ijk P_jk,
  /// for a quartic one (p) sum_kl E_ijkl P_kl at the pairs (i, j).
  /// @param P       (p) as add_pairs() makes it
  void contract(std::span<const float> P, std::span<float> result) const;

 private:
  int variables_ = 0;
  RoundedRows rows_;
};

/// P += factor a a^T, with what stands beside the diagonal doubled: as contract() wants it.
/// @param P  (p)
void add_pairs(std::span<const float> a, float factor, std::span<float> P);

/// matrix += pairs, on both sides of the diagonal.
/// @param stride  of the matrix's rows, >= n
void add_to_matrix(std::span<const float> pairs, int n, std::size_t stride,
                   std::span<float> matrix);

}  // namespace palpable
