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

}  // namespace palpable
