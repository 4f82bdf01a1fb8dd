#include "palpable/common/response/symmetric_form.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>

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

}  // namespace palpable
