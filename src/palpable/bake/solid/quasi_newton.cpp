#include "palpable/bake/solid/quasi_newton.h"

#include "palpable/common/material/tensor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

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

void QuasiNewton::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                        const LinearMap& apply_factor) {
  if (pairs_.empty()) {
    apply_factor(b, x);
    return;
  }
  // The two loops of L-BFGS (Nocedal and Wright, algorithm 7.4), on b scaled to numbers of order
  // one. Each pass over memory adds one vector and multiplies by the next.
  const double scale = b.cwiseAbs().maxCoeff();
  if (scale == 0.0) {
    x.setZero(b.size());
    return;
  }
  const std::size_t count = pairs_.size();
  q_.setZero(pairs_.front().s.padded_size());
  auto q = q_.head(b.size());
  q = (b / scale).cast<float>();
  shares_.resize(count);
  float along = dot(simd_, pairs_.back().s, q_);
  for (std::size_t i = count; i-- > 0;) {
    const Pair& pair = pairs_[i];
    shares_[i] = pair.inverse_curvature * static_cast<double>(along);
    // After the last pair the product is not used; any vector will do.
    along = add_then_dot(simd_, static_cast<float>(-shares_[i]), pair.y, q_,
                         pairs_[i > 0 ? i - 1 : 0].s);
  }
  wide_ = q.cast<double>();
  apply_factor(wide_, x);
  q = x.cast<float>();
  along = dot(simd_, pairs_.front().y, q_);
  for (std::size_t i = 0; i < count; ++i) {
    const Pair& pair = pairs_[i];
    const double share = pair.inverse_curvature * static_cast<double>(along);
    along = add_then_dot(simd_, static_cast<float>(shares_[i] - share), pair.s, q_,
                         pairs_[i + 1 < count ? i + 1 : i].y);
  }
  x = scale * q.cast<double>();
}

void QuasiNewton::record(const Eigen::VectorXd& s, const Eigen::VectorXd& Ks) {
  // The memory of an old pair is used again: of the oldest recorded one, or of one given up.
  Pair pair;
  auto& source = static_cast<int>(recorded_.size()) == capacity_ ? recorded_ : spare_;
  if (!source.empty()) {
    pair = std::move(source.front());
    source.pop_front();
  }
  // The update does not depend on the length of s, but single precision has a small range.
  const double length = s.norm();
  pair.s.assign(s / length);
  pair.y.assign(Ks / length);
  pair.inverse_curvature = 1.0 / pair.s.dot(pair.y);
  if (pair.inverse_curvature > 0.0) {
    recorded_.push_back(std::move(pair));
  } else {  // rounding has made the curvature negative
    spare_.push_back(std::move(pair));
  }
}

void QuasiNewton::use_recorded() {
  for (Pair& pair : recorded_) {
    if (static_cast<int>(pairs_.size()) == capacity_) {
      spare_.push_back(std::move(pairs_.front()));
      pairs_.pop_front();
    }
    pairs_.push_back(std::move(pair));
  }
  recorded_.clear();
}

}  // namespace palpable
