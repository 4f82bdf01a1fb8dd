#include "palpable/common/contact/dense_solve.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

// Columns that are eliminated together: each of the remaining rows is then read and written once
// for all of them. Each number is changed in the same order as by one column after the other, so
// the result is the same to the bit.
constexpr std::size_t kTogether = 4;

// Subtracts factors[0] times the first of the rows from `row`, then factors[1] times the second,
// and so on.
void subtract_rows(const double* factors, std::size_t count, const double* rows, std::size_t stride,
                   std::size_t length, double* row) {
  if (count == kTogether) {
    const double *a = rows, *b = a + stride, *c = b + stride, *d = c + stride;
    for (std::size_t j = 0; j < length; ++j) {
      row[j] =
          row[j] - factors[0] * a[j] - factors[1] * b[j] - factors[2] * c[j] - factors[3] * d[j];
    }
    return;
  }
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t j = 0; j < length; ++j) row[j] -= factors[k] * rows[k * stride + j];
  }
}

// Eliminates columns first .. last - 1 among themselves, with exchanges of whole rows. Below the
// diagonal stand the factors by which rows are subtracted from others. Returns false without a
// pivot.
bool eliminate_panel(double* A, std::size_t n, std::size_t first, std::size_t last, double* B,
                     std::size_t columns) {
  for (std::size_t k = first; k < last; ++k) {
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
      const double factor = A[i * n + k] /= A[k * n + k];
      for (std::size_t j = k + 1; j < last; ++j) A[i * n + j] -= factor * A[k * n + j];
    }
  }
  return true;
}

}  // namespace

bool solve_in_place(double* A, std::size_t n, double* B, std::size_t columns) {
  for (std::size_t first = 0; first < n; first += kTogether) {
    const std::size_t last = std::min(first + kTogether, n);
    if (!eliminate_panel(A, n, first, last, B, columns)) return false;
    for (std::size_t i = first + 1; i < n; ++i) {
      const double* factors = A + i * n + first;
      const std::size_t count = std::min(i, last) - first;
      const auto is_zero = [](double factor) { return factor == 0; };
      if (std::all_of(factors, factors + count, is_zero)) continue;
      subtract_rows(factors, count, A + first * n + last, n, n - last, A + i * n + last);
      subtract_rows(factors, count, B + first * columns, columns, columns, B + i * columns);
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    double* row = B + i * columns;
    for (std::size_t k = n; k-- > i + 1;) {
      subtract_rows(A + i * n + k, 1, B + k * columns, columns, columns, row);
    }
    for (std::size_t j = 0; j < columns; ++j) row[j] /= A[i * n + i];
  }
  return true;
}

}  // namespace palpable
