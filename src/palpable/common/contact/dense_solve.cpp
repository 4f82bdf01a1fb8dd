#include "palpable/common/contact/dense_solve.h"

#include <algorithm>
#include <cmath>

namespace palpable {

bool solve_in_place(double* A, std::size_t n, double* B, std::size_t columns) {
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (std::abs(A[i * n + k]) > std::abs(A[pivot * n + k])) pivot = i;
    }
    if (!(std::abs(A[pivot * n + k]) > 0)) return false;
    if (pivot != k) {
      std::swap_ranges(A + k * n, A + (k + 1) * n, A + pivot * n);
      std::swap_ranges(B + k * columns, B + (k + 1) * columns, B + pivot * columns);
    }
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = A[i * n + k] / A[k * n + k];
      if (factor == 0) continue;
      for (std::size_t j = k; j < n; ++j) A[i * n + j] -= factor * A[k * n + j];
      for (std::size_t j = 0; j < columns; ++j) B[i * columns + j] -= factor * B[k * columns + j];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = 0; j < columns; ++j) B[k * columns + j] /= A[k * n + k];
    for (std::size_t i = 0; i < k; ++i) {
      const double factor = A[i * n + k];
      for (std::size_t j = 0; j < columns; ++j) B[i * columns + j] -= factor * B[k * columns + j];
    }
  }
  return true;
}

}  // namespace palpable
