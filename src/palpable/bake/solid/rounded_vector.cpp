#include "palpable/bake/solid/rounded_vector.h"

#include "palpable/common/material/tensor.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace palpable {
namespace {

constexpr int kWidth = 16;
constexpr int kSums = 4;  // independent partial sums: a single one would wait for its own result
constexpr int kStep = kWidth * kSums;
constexpr double kLargest = 32767.0;

using Floats = float __attribute__((vector_size(kWidth * sizeof(float))));
using Integers = std::int16_t __attribute__((vector_size(kWidth * sizeof(std::int16_t))));

PALPABLE_ALWAYS_INLINE Floats widened_floats(const std::int16_t* from) {
  Integers integers;
  std::memcpy(&integers, from, sizeof integers);
  return __builtin_convertvector(integers, Floats);
}

PALPABLE_ALWAYS_INLINE float sum_of_lanes(const Floats (&sums)[kSums]) {
  const Floats all = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  float sum = 0.0F;
  for (int lane = 0; lane < kWidth; ++lane) sum += all[lane];
  return sum;
}

struct Dot {
  PALPABLE_ALWAYS_INLINE static float run(const std::int16_t* v, const float* q, std::size_t size) {
    Floats sums[kSums] = {};
    for (std::size_t i = 0; i < size; i += kStep) {
      for (int s = 0; s < kSums; ++s) {
        Floats here;
        std::memcpy(&here, q + i + s * kWidth, sizeof here);
        sums[s] += widened_floats(v + i + s * kWidth) * here;
      }
    }
    return sum_of_lanes(sums);
  }
};

struct AddThenDot {
  PALPABLE_ALWAYS_INLINE static float run(float share, const std::int16_t* v, float* q,
                                          const std::int16_t* w, std::size_t size) {
    Floats sums[kSums] = {};
    for (std::size_t i = 0; i < size; i += kStep) {
      for (int s = 0; s < kSums; ++s) {
        Floats here;
        std::memcpy(&here, q + i + s * kWidth, sizeof here);
        here += share * widened_floats(v + i + s * kWidth);
        std::memcpy(q + i + s * kWidth, &here, sizeof here);
        sums[s] += widened_floats(w + i + s * kWidth) * here;
      }
    }
    return sum_of_lanes(sums);
  }
};

}  // namespace

void RoundedVector::assign(const Eigen::VectorXd& v) {
  const auto size = static_cast<std::size_t>(v.size());
  integers_.assign((size + kStep - 1) / kStep * kStep, 0);
  const double largest = v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0;
  step_ = static_cast<float>(largest / kLargest);
  if (!(step_ > 0.0F)) return;
  // Divides by the step as it is stored, a float. Where that is rounded down, the exact quotient
  // keeps the largest integer at 32767.
  const double inverse = std::min(kLargest / largest, 1.0 / static_cast<double>(step_));
  for (std::size_t i = 0; i < size; ++i) {
    integers_[i] = static_cast<std::int16_t>(std::lrint(inverse * v[static_cast<Eigen::Index>(i)]));
  }
}

double RoundedVector::dot(const RoundedVector& w) const {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < integers_.size(); ++i) {
    sum += std::int64_t{integers_[i] * w.integers_[i]};
  }
  return static_cast<double>(sum) * static_cast<double>(step_) * static_cast<double>(w.step_);
}

float dot(SimdLevel simd, const RoundedVector& v, const Eigen::VectorXf& q) {
  const std::int16_t* const integers = v.integers_.data();
  const float* const numbers = q.data();
  const std::size_t size = v.integers_.size();
  return v.step_ * run_at<Dot>(simd, integers, numbers, size);
}

float add_then_dot(SimdLevel simd, float share, const RoundedVector& v, Eigen::VectorXf& q,
                   const RoundedVector& w) {
  const float times = share * v.step_;
  const std::int16_t* const added = v.integers_.data();
  const std::int16_t* const dotted = w.integers_.data();
  float* const numbers = q.data();
  const std::size_t size = v.integers_.size();
  return w.step_ * run_at<AddThenDot>(simd, times, added, numbers, dotted, size);
}

}  // namespace palpable
