#include "palpable/common/response/symmetric_form.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/row_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace palpable {
namespace {

constexpr float kLargestWord = 32767.0f;

}  // namespace

std::size_t distinct_coefficients(int variables, int degree) {
  const auto n = static_cast<std::size_t>(variables);
  const std::size_t cubic = n * (n + 1) * (n + 2) / 6;
  return degree == 3 ? cubic : cubic * (n + 3) / 4;
}

std::size_t runs_of(int variables, int degree) {
  const auto n = static_cast<std::size_t>(variables);
  return degree == 3 ? n * (n + 1) / 2 : distinct_coefficients(variables, 3);
}

SymmetricForm rounded(int variables, int degree, std::span<const double> coefficients) {
  PALPABLE_EXPECT(degree == 3 || degree == 4, "forms of the third and fourth degree are kept");
  PALPABLE_EXPECT(coefficients.size() == distinct_coefficients(variables, degree),
                  "as many coefficients as are distinct");
  SymmetricForm form{variables, degree, {}, {}};
  form.values.reserve(coefficients.size());
  form.scale.reserve(runs_of(variables, degree));
  const auto add_run = [&](int first) {
    const auto run =
        coefficients.subspan(form.values.size(), static_cast<std::size_t>(variables - first));
    double largest = 0;
    for (const double c : run) largest = std::max(largest, std::abs(c));
    const auto scale = static_cast<float>(largest / static_cast<double>(kLargestWord));
    form.scale.push_back(scale);
    for (const double c : run) {
      form.values.push_back(
          scale > 0 ? static_cast<std::int16_t>(std::lround(c / static_cast<double>(scale))) : 0);
    }
  };
  for (int i = 0; i < variables; ++i) {
    for (int j = i; j < variables; ++j) {
      if (degree == 3) {
        add_run(j);
      } else {
        for (int k = j; k < variables; ++k) add_run(k);
      }
    }
  }
  return form;
}

SymmetricForm leading(const SymmetricForm& form, int variables) {
  PALPABLE_EXPECT(form.degree == 3 && variables <= form.variables,
                  "the first variables of a cubic form");
  SymmetricForm result{variables, form.degree, {}, {}};
  result.values.reserve(distinct_coefficients(variables, form.degree));
  result.scale.reserve(runs_of(variables, form.degree));
  auto run = form.values.begin();
  auto scale = form.scale.begin();
  for (int i = 0; i < variables; ++i) {
    for (int j = i; j < form.variables; run += form.variables - j, ++scale, ++j) {
      if (j >= variables) continue;
      result.values.insert(result.values.end(), run, run + (variables - j));
      result.scale.push_back(*scale);
    }
  }
  return result;
}

namespace {

std::size_t pair_count(int n) {
  return static_cast<std::size_t>(n) * static_cast<std::size_t>(n + 1) / 2;
}

// Index of the pair (i, j), i <= j.
std::size_t pair_at(int n, int i, int j) {
  return pair_count(n) - pair_count(n - i) + static_cast<std::size_t>(j - i);
}

RowsOfFloats cubic_rows(const SymmetricForm& form) {
  const int n = form.variables;
  RowsOfFloats rows(n, static_cast<Eigen::Index>(pair_count(n)));
  const std::int16_t* value = form.values.data();
  const float* scale = form.scale.data();
  const auto put = [&](int one, int j, int k, float a) {
    rows(one, static_cast<Eigen::Index>(pair_at(n, j, k))) = a;
  };
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j, ++scale) {
      for (int k = j; k < n; ++k) {
        const float a = *scale * static_cast<float>(*value++);
        put(i, j, k, a);
        put(j, i, k, a);
        put(k, i, j, a);
      }
    }
  }
  return rows;
}

RowsOfFloats quartic_rows(const SymmetricForm& form) {
  const int n = form.variables;
  const auto p = static_cast<Eigen::Index>(pair_count(n));
  RowsOfFloats rows(p, p);
  const std::int16_t* value = form.values.data();
  const float* scale = form.scale.data();
  const auto put = [&](int i, int j, int k, int l, float e) {
    const auto ij = static_cast<Eigen::Index>(pair_at(n, i, j));
    const auto kl = static_cast<Eigen::Index>(pair_at(n, k, l));
    rows(ij, kl) = e;
    rows(kl, ij) = e;
  };
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) {
      for (int k = j; k < n; ++k, ++scale) {
        for (int l = k; l < n; ++l) {
          const float e = *scale * static_cast<float>(*value++);
          put(i, j, k, l, e);
          put(i, k, j, l, e);
          put(i, l, j, k, e);
        }
      }
    }
  }
  return rows;
}

}  // namespace

std::size_t pair_width(int variables) { return padded(pair_count(variables)); }

FormRows::FormRows(const SymmetricForm& form)
    : variables_(form.variables),
      rows_(rounded(form.degree == 3 ? cubic_rows(form) : quartic_rows(form))) {}

void FormRows::add_cubic(std::span<const float> a, float factor, std::span<float> pairs) const {
  PALPABLE_EXPECT(a.size() == rows_.scale.size() && pairs.size() == rows_.width,
                  "coordinates of the form's variables, and room for all pairs");
  std::array<float, 8> factors;
  for (std::size_t first = 0; first < a.size(); first += factors.size()) {
    const std::size_t count = std::min(factors.size(), a.size() - first);
    for (std::size_t i = 0; i < count; ++i) factors[i] = factor * a[first + i];
    add_rows(rows_, first, {factors.data(), count}, pairs);
  }
}

void FormRows::contract(std::span<const float> P, std::span<float> result) const {
  PALPABLE_EXPECT(P.size() == rows_.width && result.size() >= rows_.scale.size(),
                  "a matrix of the form's variables, and room for the result");
  const std::size_t count = rows_.scale.size();
  best_row_kernels().dots(rows_.row(0), count, P, result.data());
  for (std::size_t i = 0; i < count; ++i) result[i] *= rows_.scale[i];
}

void add_pairs(std::span<const float> a, float factor, std::span<float> P) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const float one = factor * a[i], twice = 2 * one;
    P[at++] += one * a[i];
    for (std::size_t j = i + 1; j < a.size(); ++j) P[at++] += twice * a[j];
  }
}

void add_to_matrix(std::span<const float> pairs, int n, std::size_t stride,
                   std::span<float> matrix) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    matrix[i * stride + i] += pairs[at++];
    for (std::size_t j = i + 1; j < static_cast<std::size_t>(n); ++j, ++at) {
      matrix[i * stride + j] += pairs[at];
      matrix[j * stride + i] += pairs[at];
    }
  }
}

}  // namespace palpable
