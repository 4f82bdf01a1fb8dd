/// @file
/// Small dense systems of linear equations, row by row, in memory that the caller keeps.
#pragma once

#include <cstddef>

namespace palpable {

/// Replaces B by A^-1 B, by elimination with exchanged rows; A is overwritten. Allocates nothing.
/// @param A        (n x n)
/// @param B        (n x columns)
/// @return false: A is singular, and B is not to be used. An A that is nearly singular may leave
///         numbers in B that are not finite
[[nodiscard]] bool solve_in_place(double* A, std::size_t n, double* B, std::size_t columns);

}  // namespace palpable
