/// @file
/// Symmetric forms of the third and fourth degree in a few variables, stored as their distinct
/// coefficients. They are the terms of a body's stored energy beyond its stiffness, in some modes.
///
///   n  variables
///
///     cubic      A(a, a, a) = sum over i, j, k of A_ijk a_i a_j a_k
///     quartic    E(a, a, a, a), likewise
///
/// Distinct coefficients are those with i <= j <= k (<= l), ordered by i, then j, then k: n (n + 1)
/// (n + 2) / 6 of them, or n (n + 1) (n + 2) (n + 3) / 24.
#pragma once

#include "palpable/common/response/rounded_rows.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// How many distinct coefficients a form has. @param degree  3 or 4
[[nodiscard]] std::size_t distinct_coefficients(int variables, int degree);

/// Coefficients in 16 bits; each run over the last index has a factor of its own.
struct SymmetricForm {
  int variables = 0;
  int degree = 3;                    ///< 3 or 4
  std::vector<std::int16_t> values;  ///< the distinct coefficients
  std::vector<float> scale;          ///< unit of `values`, of each run over the last index
};

/// @param coefficients  the distinct ones
[[nodiscard]] SymmetricForm rounded(int variables, int degree,
                                    std::span<const double> coefficients);

/// The form in its first variables, the others set to 0. @pre the degree is 3, and variables <=
/// form.variables
[[nodiscard]] SymmetricForm leading(const SymmetricForm& form, int variables);

/// How many runs over the last index a form has.
[[nodiscard]] std::size_t runs_of(int variables, int degree);

// Symmetric forms laid out for evaluation: long rows over pairs of indices, which suit vector
// instructions.
//
//   n  variables      p  pairs i <= j, ordered by i, then j: n (n + 1) / 2, padded to a multiple
//                        of 16 with zeros
//
//     cubic      n rows: row i has A_ijk for all pairs (j, k)
//     quartic    one row for each pair (i, j), with E_ijkl for all pairs (k, l)
//
// This layout has three to six times as many numbers as a body file stores (SymmetricForm), and
// is ten times as fast.

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
