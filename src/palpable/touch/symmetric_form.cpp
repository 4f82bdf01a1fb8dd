#include "palpable/touch/symmetric_form.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr float kLargest = 32767.0f;

// All loops below go along runs: the last index, with the others fixed. What a coefficient adds
// follows one rule: of the indices i <= j <= k (<= l) each *distinct* one is taken out once and its
// a multiplies; the others say where the product goes.

// One run of a cubic form: coefficients (i, j, k) for k = j .. n - 1, `run[k - j]`.
template <class Value>
void add_run_to_matrix(const Value* run, float scale, int i, int j, int n, const float* a,
                       float* matrix) {
  const float a_i = scale * a[i], a_j = scale * a[j];
  float* row_j = matrix + static_cast<std::ptrdiff_t>(j) * n;
  float* row_i = matrix + static_cast<std::ptrdiff_t>(i) * n;
  for (int k = j; k < n; ++k) row_j[k] += a_i * static_cast<float>(run[k - j]);
  if (i != j) {
    for (int k = j; k < n; ++k) row_i[k] += a_j * static_cast<float>(run[k - j]);
  }
  float sum = 0;
  for (int k = j + 1; k < n; ++k) sum += a[k] * static_cast<float>(run[k - j]);
  row_i[j] += scale * sum;
}

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
    const auto scale = static_cast<float>(largest / static_cast<double>(kLargest));
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

void add_cubic_matrix(const SymmetricForm& form, std::span<const float> a, float factor,
                      std::span<float> matrix) {
  const int n = form.variables;
  const std::int16_t* run = form.values.data();
  const float* scale = form.scale.data();
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) {
      add_run_to_matrix(run, factor * *scale++, i, j, n, a.data(), matrix.data());
      run += n - j;
    }
  }
}

void add_cubic_matrix(int variables, std::span<const float> cubic, std::span<const float> a,
                      float factor, std::span<float> matrix) {
  const int n = variables;
  const float* run = cubic.data();
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) {
      add_run_to_matrix(run, factor, i, j, n, a.data(), matrix.data());
      run += n - j;
    }
  }
}

void add_cubic_contraction(const SymmetricForm& form, std::span<const float> P, float factor,
                           std::span<float> vector) {
  const int n = form.variables;
  const std::int16_t* run = form.values.data();
  const float* scale_of_run = form.scale.data();
  for (int i = 0; i < n; ++i) {
    const float* P_i = P.data() + static_cast<std::ptrdiff_t>(i) * n;
    for (int j = i; j < n; ++j) {
      const float scale = factor * *scale_of_run++;
      const float* P_j = P.data() + static_cast<std::ptrdiff_t>(j) * n;
      // The index that is taken out says where the sum goes; the other two are a pair of P, which
      // stands there twice unless they are equal.
      const float pair = (i == j ? 1.0f : 2.0f) * scale * P_i[j];
      for (int k = j; k < n; ++k) vector[k] += pair * static_cast<float>(run[k - j]);
      float to_j = 0, to_i = 0;
      for (int k = j + 1; k < n; ++k) {
        to_j += P_i[k] * static_cast<float>(run[k - j]);
        to_i += P_j[k] * static_cast<float>(run[k - j]);
      }
      vector[j] += 2 * scale * to_j;
      if (i != j) vector[i] += scale * (2 * to_i + P_j[j] * static_cast<float>(run[0]));
      run += n - j;
    }
  }
}

void add_quartic_contraction(const SymmetricForm& form, std::span<const float> a, float factor,
                             std::span<float> cubic) {
  const int n = form.variables;
  // Where the run (i, j, .) of a cubic form begins, less j: element k lies at first + k.
  const auto cubic_run = [n](int i, int j) {
    const auto tetrahedron = [](std::ptrdiff_t m) { return m * (m + 1) * (m + 2) / 6; };
    const auto triangle = [](std::ptrdiff_t m) { return m * (m + 1) / 2; };
    return tetrahedron(n) - tetrahedron(n - i) + triangle(n - i) - triangle(n - j) - j;
  };
  const std::int16_t* run = form.values.data();
  const float* scale_of_run = form.scale.data();
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) {
      for (int k = j; k < n; ++k) {
        const float scale = factor * *scale_of_run++;
        float* jk = cubic.data() + cubic_run(j, k);
        float* ik = cubic.data() + cubic_run(i, k);
        float* ij = cubic.data() + cubic_run(i, j);
        const float a_i = scale * a[i], a_j = scale * a[j], a_k = scale * a[k];
        for (int l = k; l < n; ++l) jk[l] += a_i * static_cast<float>(run[l - k]);
        if (j != i) {
          for (int l = k; l < n; ++l) ik[l] += a_j * static_cast<float>(run[l - k]);
        }
        if (k != j) {
          for (int l = k; l < n; ++l) ij[l] += a_k * static_cast<float>(run[l - k]);
        }
        float sum = 0;
        for (int l = k + 1; l < n; ++l) sum += a[l] * static_cast<float>(run[l - k]);
        ij[k] += scale * sum;
        run += n - k;
      }
    }
  }
}

}  // namespace palpable
