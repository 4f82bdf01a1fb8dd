/// @file
/// Symmetric forms of the third and fourth degree in a few variables, kept as their distinct
/// coefficients: what the body's stored energy is beyond its stiffness, in some modes.
///
///   n  variables
///
///     cubic      A(a, a, a) = sum over i, j, k of A_ijk a_i a_j a_k
///     quartic    E(a, a, a, a), likewise
///
/// Distinct coefficients are those with i <= j <= k (<= l), ordered by i, then j, then k: n (n + 1)
/// (n + 2) / 6 of them, or n (n + 1) (n + 2) (n + 3) / 24.
#pragma once

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
  std::vector<float> scale;          ///< per unit of `values`: of each run over the last index
};

/// @param coefficients  the distinct ones
[[nodiscard]] SymmetricForm rounded(int variables, int degree,
                                    std::span<const double> coefficients);

/// How many runs over the last index a form has.
[[nodiscard]] std::size_t runs_of(int variables, int degree);

/// matrix += factor A(a, ., .) of a cubic form: its upper triangle, row by row.
/// @param a       (n)
/// @param matrix  (n x n)
void add_cubic_matrix(const SymmetricForm& form, std::span<const float> a, float factor,
                      std::span<float> matrix);

/// vector_k += factor sum_ij A_ijk P_ij for a symmetric matrix P: a contraction with several codes
/// at once costs as much as with one.
/// @param P  (n x n) symmetric, both triangles
void add_cubic_contraction(const SymmetricForm& form, std::span<const float> P, float factor,
                           std::span<float> vector);

/// cubic += factor E(a, ., ., .) of a quartic form, as distinct coefficients of a cubic one.
void add_quartic_contraction(const SymmetricForm& form, std::span<const float> a, float factor,
                             std::span<float> cubic);

/// matrix += factor C(a, ., .) for distinct coefficients in floats; upper triangle.
void add_cubic_matrix(int variables, std::span<const float> cubic, std::span<const float> a,
                      float factor, std::span<float> matrix);

}  // namespace palpable
