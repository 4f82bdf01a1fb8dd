#include "palpable/common/contact/dense_solve.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace palpable {
namespace {

TEST_CASE("a small system is solved for several right sides, a singular one is refused",
          "[contact]") {
  // The first pivot is 0, so that rows must be exchanged.
  std::vector<double> A{0, 2, 1, 1, 1, 0, 3, 0, 1};
  // A times the columns (1, 2, 3) and (-1, 0, 4).
  std::vector<double> B{7, 4, 3, -1, 6, 1};
  REQUIRE(solve_in_place(A.data(), 3, B.data(), 2));
  const std::vector<double> expected{1, -1, 2, 0, 3, 4};
  for (std::size_t k = 0; k < 6; ++k) CHECK(B[k] == Approx(expected[k]).margin(1e-14));

  std::vector<double> singular{1, 2, 2, 4}, b{1, 1};
  CHECK_FALSE(solve_in_place(singular.data(), 2, b.data(), 1));
}

// One column after the other.
void solve_plainly(std::vector<double> A, std::size_t n, std::vector<double>& B,
                   std::size_t columns) {
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (std::abs(A[i * n + k]) > std::abs(A[pivot * n + k])) pivot = i;
    }
    std::swap_ranges(&A[k * n], &A[k * n] + n, &A[pivot * n]);
    if (pivot != k)
      std::swap_ranges(&B[k * columns], &B[k * columns] + columns, &B[pivot * columns]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = A[i * n + k] / A[k * n + k];
      for (std::size_t j = k + 1; j < n; ++j) A[i * n + j] -= factor * A[k * n + j];
      for (std::size_t j = 0; j < columns; ++j) B[i * columns + j] -= factor * B[k * columns + j];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = 0; j < columns; ++j) B[k * columns + j] /= A[k * n + k];
    for (std::size_t i = 0; i < k; ++i) {
      for (std::size_t j = 0; j < columns; ++j) {
        B[i * columns + j] -= A[i * n + k] * B[k * columns + j];
      }
    }
  }
}

TEST_CASE("columns that are eliminated together give the bits of one after the other",
          "[contact]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  for (const std::size_t n : {1U, 2U, 3U, 4U, 5U, 7U, 8U, 31U, 64U, 93U}) {
    for (const std::size_t columns : {1U, 3U}) {
      CAPTURE(n, columns);
      std::vector<double> A(n * n), B(n * columns);
      // One in four is 0, as where points do not rub.
      for (double& a : A) a = number(random) > 0.5 ? 0 : number(random);
      for (std::size_t k = 0; k < n; ++k) A[k * n + k] += 0.1;
      for (double& b : B) b = number(random);
      std::vector<double> plain = B;
      solve_plainly(A, n, plain, columns);
      REQUIRE(solve_in_place(A.data(), n, B.data(), columns));
      CHECK(B == plain);
    }
  }
}

}  // namespace
}  // namespace palpable
