#include "palpable/common/response/symmetric_form.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

// A form given by its distinct coefficients, with access to all of them.
struct Form {
  int n, degree;
  std::vector<double> distinct;

  Form(int variables, int the_degree, unsigned seed) : n(variables), degree(the_degree) {
    auto random = test::random_case(seed);
    std::normal_distribution<double> entry;
    distinct.resize(distinct_coefficients(n, degree));
    for (double& c : distinct) c = entry(random);
  }

  // Runs through the distinct ones until the sorted indices are reached: slow and obvious.
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

std::vector<float> some_coordinates(int n, unsigned seed) {
  auto random = test::random_case(seed);
  std::normal_distribution<float> entry;
  std::vector<float> a(static_cast<std::size_t>(n));
  for (float& x : a) x = entry(random);
  return a;
}

constexpr double kRounding = 5e-4;  // 16 bits of numbers up to 4, summed over some dozens

TEST_CASE("a form's leading part is the form where the other variables are 0",
          "[response][forms]") {
  const SymmetricForm form = rounded(5, 3, Form(5, 3, 8).distinct);
  const FormRows all(form), some(leading(form, 3));
  const std::vector<float> a = some_coordinates(3, 9);
  std::vector<float> with_zeros = a;
  with_zeros.resize(5, 0.0f);
  std::vector<float> P(all.width(), 0.0f), P_some(some.width(), 0.0f), q(5), q_some(3);
  add_pairs(with_zeros, 1.0f, P);
  add_pairs(a, 1.0f, P_some);
  all.contract(P, q);
  some.contract(P_some, q_some);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(std::abs(q_some[i] - q[i]) < tolerance(2e-3, "rows are rounded to 16 bits anew"));
  }
  CHECK_THROWS_AS(leading(form, 6), ContractViolation);
}

TEST_CASE("a cubic form's matrix is the sum over all its coefficients", "[response][forms]") {
  const int n = 5;
  const Form form(n, 3, 1);
  const FormRows rows(rounded(n, 3, form.distinct));
  const std::vector<float> a = some_coordinates(n, 2);
  std::vector<float> pairs(rows.width(), 0.0f), matrix(n * 7, 0.25f);
  rows.add_cubic(a, -0.5f, pairs);
  add_to_matrix(pairs, n, 7, matrix);
  for (int j = 0; j < n; ++j) {
    for (int k = 0; k < n; ++k) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += static_cast<double>(a[i]) * form.at({i, j, k});
      INFO(j << " " << k);
      CHECK(static_cast<double>(matrix[7 * j + k]) ==
            Approx(0.25 - 0.5 * sum).margin(tolerance(kRounding, "16 bits")));
    }
    CHECK(matrix[7 * j + 6] == 0.25f);
  }
}

TEST_CASE("a contraction with a matrix is the sum over all pairs", "[response][forms]") {
  const int n = 6;
  const Form form(n, 3, 3);
  const FormRows rows(rounded(n, 3, form.distinct));
  const std::vector<float> a = some_coordinates(n, 4), b = some_coordinates(n, 5);
  std::vector<float> P(rows.width(), 0.0f), vector(6);
  add_pairs(a, 1.0f, P);
  add_pairs(b, -0.7f, P);
  rows.contract(P, vector);
  for (int k = 0; k < n; ++k) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        sum += static_cast<double>(a[i] * a[j] - 0.7f * b[i] * b[j]) * form.at({i, j, k});
      }
    }
    CHECK(static_cast<double>(vector[k]) ==
          Approx(sum).margin(tolerance(10 * kRounding, "16 bits, 36 products")));
  }
}

TEST_CASE("a quartic form with one vector twice is a matrix", "[response][forms]") {
  const int n = 5;
  const Form form(n, 4, 6);
  const FormRows rows(rounded(n, 4, form.distinct));
  const std::vector<float> a = some_coordinates(n, 7);
  std::vector<float> P(rows.width(), 0.0f), pairs(rows.width()), matrix(25, 0.0f);
  add_pairs(a, 1.0f, P);
  rows.contract(P, pairs);
  add_to_matrix(pairs, n, 5, matrix);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      double sum = 0;
      for (int k = 0; k < n; ++k) {
        for (int l = 0; l < n; ++l) {
          sum += static_cast<double>(a[k] * a[l]) * form.at({i, j, k, l});
        }
      }
      INFO(i << " " << j);
      CHECK(static_cast<double>(matrix[5 * i + j]) ==
            Approx(sum).margin(tolerance(10 * kRounding, "16 bits, 25 products")));
    }
  }
}

TEST_CASE("forms of one variable are numbers", "[response][forms]") {
  const FormRows cubic(rounded(1, 3, std::array{2.0}));
  std::vector<float> pairs(cubic.width(), 0.0f);
  cubic.add_cubic(std::array{3.0f}, 1, pairs);
  CHECK(pairs[0] == Approx(6));
  const SymmetricForm nothing = rounded(2, 4, std::vector<double>(5, 0.0));
  CHECK(std::all_of(nothing.values.begin(), nothing.values.end(), [](auto v) { return v == 0; }));
  CHECK_THROWS_AS(rounded(2, 3, std::array{1.0, 2.0}), ContractViolation);
}

TEST_CASE("contractions allocate nothing", "[response][frame loop]") {
  const FormRows cubic(rounded(16, 3, Form(16, 3, 1).distinct));
  const FormRows quartic(rounded(16, 4, Form(16, 4, 1).distinct));
  const std::vector<float> a = some_coordinates(16, 1);
  std::vector<float> pairs(cubic.width()), vector(16), matrix(256), others(cubic.width());
  CHECK(test::allocations_during([&] {
          cubic.add_cubic(a, 1, pairs);
          add_pairs(a, 1, pairs);
          cubic.contract(pairs, vector);
          quartic.contract(pairs, others);
          add_to_matrix(pairs, 16, 16, matrix);
        }) == 0);
}

}  // namespace

}  // namespace palpable
