#include "palpable/touch/symmetric_form.h"

#include "palpable/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

// Distinct coefficients, and a reader of all of them.
struct Form {
  int n, degree;
  std::vector<double> distinct;

  Form(int variables, int the_degree, unsigned seed) : n(variables), degree(the_degree) {
    auto random = test::random_case(seed);
    std::normal_distribution<double> entry;
    distinct.resize(distinct_coefficients(n, degree));
    for (double& c : distinct) c = entry(random);
  }

  // Counts through the distinct ones until the sorted indices come: slow and obvious.
  [[nodiscard]] double at(std::vector<int> index) const {
    std::sort(index.begin(), index.end());
    std::size_t number = 0;
    for (int i = 0; i < n; ++i) {
      for (int j = i; j < n; ++j) {
        for (int k = j; k < n; ++k) {
          if (degree == 3) {
            if (index == std::vector{i, j, k}) return distinct[number];
            ++number;
            continue;
          }
          for (int l = k; l < n; ++l) {
            if (index == std::vector{i, j, k, l}) return distinct[number];
            ++number;
          }
        }
      }
    }
    FAIL("no such index");
    return 0;
  }
};

std::vector<float> some_code(int n, unsigned seed) {
  auto random = test::random_case(seed);
  std::normal_distribution<float> entry;
  std::vector<float> a(static_cast<std::size_t>(n));
  for (float& x : a) x = entry(random);
  return a;
}

constexpr double kRounding = 5e-4;  // 16 bits of numbers up to 4, summed over some dozens

TEST_CASE("a cubic form's matrix is the sum over all its coefficients", "[touch][forms]") {
  const int n = 5;
  const Form form(n, 3, 1);
  const SymmetricForm kept = rounded(n, 3, form.distinct);
  const std::vector<float> a = some_code(n, 2);
  std::vector<float> matrix(25, 0.25f);
  add_cubic_matrix(kept, a, -0.5f, matrix);
  std::vector<float> floats(form.distinct.begin(), form.distinct.end());
  std::vector<float> from_floats(25, 0.25f);
  add_cubic_matrix(n, floats, a, -0.5f, from_floats);
  for (int j = 0; j < n; ++j) {
    for (int k = j; k < n; ++k) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += static_cast<double>(a[i]) * form.at({i, j, k});
      INFO(j << " " << k);
      CHECK(static_cast<double>(matrix[n * j + k]) ==
            Approx(0.25 - 0.5 * sum).margin(tolerance(kRounding, "16 bits")));
      CHECK(static_cast<double>(from_floats[n * j + k]) ==
            Approx(0.25 - 0.5 * sum).margin(tolerance(1e-6, "floats")));
    }
  }
}

TEST_CASE("a contraction with a matrix is the sum over all pairs", "[touch][forms]") {
  const int n = 6;
  const Form form(n, 3, 3);
  const SymmetricForm kept = rounded(n, 3, form.distinct);
  const std::vector<float> a = some_code(n, 4), b = some_code(n, 5);
  std::vector<float> P(36);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) P[n * i + j] = a[i] * a[j] - 0.7f * b[i] * b[j];
  }
  std::vector<float> vector(6, 1.0f);
  add_cubic_contraction(kept, P, 2.0f, vector);
  for (int k = 0; k < n; ++k) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) sum += static_cast<double>(P[n * i + j]) * form.at({i, j, k});
    }
    CHECK(static_cast<double>(vector[k]) ==
          Approx(1 + 2 * sum).margin(tolerance(10 * kRounding, "16 bits, 36 products")));
  }
}

TEST_CASE("a quartic form with one code is a cubic form", "[touch][forms]") {
  const int n = 5;
  const Form form(n, 4, 6);
  const SymmetricForm kept = rounded(n, 4, form.distinct);
  const std::vector<float> a = some_code(n, 7);
  Form cubic(n, 3, 8);
  std::vector<float> result(cubic.distinct.size(), 0.5f);
  add_quartic_contraction(kept, a, 3.0f, result);
  std::copy(result.begin(), result.end(), cubic.distinct.begin());
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) {
      for (int k = j; k < n; ++k) {
        double sum = 0;
        for (int l = 0; l < n; ++l) sum += static_cast<double>(a[l]) * form.at({i, j, k, l});
        INFO(i << " " << j << " " << k);
        CHECK(cubic.at({i, j, k}) ==
              Approx(0.5 + 3 * sum).margin(tolerance(3 * kRounding, "16 bits")));
      }
    }
  }
}

TEST_CASE("forms of one variable are numbers", "[touch][forms]") {
  const SymmetricForm cubic = rounded(1, 3, std::array{2.0});
  std::vector<float> matrix(1, 0.0f);
  add_cubic_matrix(cubic, std::array{3.0f}, 1, matrix);
  CHECK(matrix[0] == Approx(6));
  const SymmetricForm nothing = rounded(2, 4, std::vector<double>(5, 0.0));
  CHECK(std::all_of(nothing.values.begin(), nothing.values.end(), [](auto v) { return v == 0; }));
  CHECK_THROWS_AS(rounded(2, 3, std::array{1.0, 2.0}), ContractViolation);
}

TEST_CASE("contractions allocate nothing", "[touch][frame loop]") {
  const SymmetricForm cubic = rounded(16, 3, Form(16, 3, 1).distinct);
  const SymmetricForm quartic = rounded(16, 4, Form(16, 4, 1).distinct);
  const std::vector<float> a = some_code(16, 1);
  std::vector<float> matrix(256), vector(16), form(distinct_coefficients(16, 3));
  CHECK(test::allocations_during([&] {
          add_cubic_matrix(cubic, a, 1, matrix);
          add_cubic_contraction(cubic, matrix, 1, vector);
          add_quartic_contraction(quartic, a, 1, form);
          add_cubic_matrix(16, form, a, 1, matrix);
        }) == 0);
}

}  // namespace
}  // namespace palpable
