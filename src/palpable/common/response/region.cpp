#include "palpable/common/response/region.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/row_kernels.h"
#include "palpable/common/response/symmetric_form.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

float squared(std::span<const float> x) {
  float sum = 0;
  for (const float value : x) sum += value * value;
  return sum;
}

}  // namespace

RegionResponse::RegionResponse(int most_modes, int most_leading) {
  const auto r = static_cast<std::size_t>(most_modes), s = static_cast<std::size_t>(most_leading);
  q_.resize(r);
  shortened_.resize(r);
  matrix_.resize(r * r);
  pairs_.resize(pair_width(most_modes));
  products_.resize(pair_width(most_leading));
  third_.resize(products_.size());
  third_matrix_.resize(s * s);
}

void RegionResponse::evaluate(const RegionForms& region, std::span<const float> a) {
  const Orders orders = evaluate_series(region, a);
  last_share_ = orders.last_share();
  if (!(last_share_ > kSeriesEnd)) return;
  const float s = orders.shortened_to(kSeriesEnd);
  for (std::size_t k = 0; k < a.size(); ++k) shortened_[k] = s * a[k];
  evaluate_series(region, {shortened_.data(), a.size()});
  for (std::size_t k = 0; k < size_; ++k) q_[k] /= s;
}

float RegionResponse::Orders::last_share() const {
  return first + second > 0 ? third / (first + second) : 0.0f;
}

// The s at which the coordinates s a have this share: s^2 third / (first + s second) = share.
float RegionResponse::Orders::shortened_to(float share) const {
  const float b = share * second;
  return (b + std::sqrt(b * b + 4 * third * share * first)) / (2 * third);
}

RegionResponse::Orders RegionResponse::evaluate_series(const RegionForms& region,
                                                       std::span<const float> a) {
  const auto r = static_cast<std::size_t>(region.cubic.variables());
  const auto s = static_cast<std::size_t>(region.quartic.variables());
  PALPABLE_EXPECT(a.size() == r && r <= q_.size() && s * s <= third_matrix_.size(),
                  "coordinates of the region, and room for it");
  size_ = r;
  const std::span<float> H(matrix_.data(), r * r), pairs(pairs_.data(), region.cubic.width());
  std::fill(H.begin(), H.end(), 0.0f);
  std::fill(pairs.begin(), pairs.end(), 0.0f);
  region.cubic.add_cubic(a, -1.0f, pairs);  // - A(a, .)
  add_to_matrix(pairs, region.cubic.variables(), r, H);
  // q_2 = 1/2 H a
  best_row_kernels().dots_floats(H.data(), r, a, q_.data());
  for (std::size_t k = 0; k < r; ++k) q_[k] *= 0.5f;
  const float second = squared({q_.data(), r});

  // T = - 1/2 E(a, a, ., .); q_3 = 1/3 T a
  const std::span<float> T(third_matrix_.data(), s * s);
  const std::span<float> products(products_.data(), region.quartic.width());
  const std::span<float> third(third_.data(), region.quartic.width());
  std::fill(T.begin(), T.end(), 0.0f);
  std::fill(products.begin(), products.end(), 0.0f);
  const std::span<const float> leading = a.first(s);
  add_pairs(leading, -0.5f, products);
  region.quartic.contract(products, third);
  add_to_matrix(third, region.quartic.variables(), s, T);
  float last = 0;
  for (std::size_t i = 0; i < s; ++i) {
    float sum = 0;
    for (std::size_t k = 0; k < s; ++k) {
      sum += T[i * s + k] * leading[k];
      H[i * r + k] += T[i * s + k];
    }
    q_[i] += sum / 3.0f;
    last += sum * sum / 9.0f;
  }
  return {std::sqrt(squared(a)), std::sqrt(second), std::sqrt(last)};
}

void RegionResponse::times(std::span<const float> x, std::span<float> result) const {
  // H is symmetric, so H x is a sum of its rows, which needs no sums across a vector register.
  std::fill(result.begin(), result.end(), 0.0f);
  best_row_kernels().add_float_rows(matrix_.data(), size_, x, result);
}

}  // namespace palpable
