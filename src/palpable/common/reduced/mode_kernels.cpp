// The loops over modes for all sets of vector instructions, by Google Highway: this file is
// compiled once for each instruction set, and the best one is chosen when the program runs. It is
// compiled without contraction of a * b + c (CMakeLists.txt), which would give results that differ
// between the instruction sets.

#include "palpable/common/reduced/mode_kernels.h"

#include "palpable/common/base/simd_targets.h"

#include <algorithm>
#include <cmath>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "palpable/common/reduced/mode_kernels.cpp"
// Every file that uses Highway begins with these includes:
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#ifndef PALPABLE_MODE_KERNELS_ONCE
#define PALPABLE_MODE_KERNELS_ONCE
namespace palpable {
namespace {

// Number of columns that are summed in one pass over the rows. With more, the processor's
// prefetchers cannot follow all columns; with fewer, u is read and written more often.
constexpr std::size_t kTogether = 8;

float von_mises_of(const float* s) {
  const float xy = s[0] - s[1], yz = s[1] - s[2], zx = s[2] - s[0];
  const float shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
  return std::sqrt(0.5f * (xy * xy + yz * yz + zx * zx) + 3.0f * shear);
}

void normalise_one(float* v) {
  const float length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  if (!(length > 0.0f)) return;
  for (int k = 0; k < 3; ++k) v[k] /= length;
}

// Sums the rows from `k` on one by one: those that are left over after whole vectors.
void sum_rows(const ModeColumns& F, const float* weights, bool add, std::span<float> u,
              std::size_t k) {
  for (; k < u.size(); ++k) {
    float value = add ? u[k] : 0.0f;
    for (std::size_t i = 0; i < F.count; ++i) value += weights[i] * F.first[i * F.stride + k];
    u[k] = value;
  }
}

void plain_sum(const ModeColumns& F, const float* weights, bool add, std::span<float> u) {
  sum_rows(F, weights, add, u, 0);
}

void plain_von_mises(const float* stress, std::span<float> result) {
  for (std::size_t k = 0; k < result.size(); ++k) result[k] = von_mises_of(stress + 6 * k);
}

void plain_normalise(float* vectors, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) normalise_one(vectors + 3 * k);
}

}  // namespace
}  // namespace palpable
#endif

HWY_BEFORE_NAMESPACE();
namespace palpable::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR
void sum(const ModeColumns& F, const float* weights, bool add, std::span<float> u) {
  plain_sum(F, weights, add, u);
}
void von_mises(const float* stress, std::span<float> result) { plain_von_mises(stress, result); }
void normalise(float* vectors, std::size_t count) { plain_normalise(vectors, count); }
#else

using Floats = hn::ScalableTag<float>;

template <std::size_t kColumns>
HWY_ATTR void sum_columns(const ModeColumns& F, const float* weights, bool add,
                          std::span<float> u) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  hn::VFromD<Floats> w[kColumns];
  for (std::size_t i = 0; i < kColumns; ++i) w[i] = hn::Set(d, weights[i]);
  std::size_t k = 0;
  for (; k + lanes <= u.size(); k += lanes) {
    auto value = add ? hn::LoadU(d, u.data() + k) : hn::Zero(d);
    for (std::size_t i = 0; i < kColumns; ++i) {
      value = hn::Add(value, hn::Mul(w[i], hn::LoadU(d, F.first + i * F.stride + k)));
    }
    hn::StoreU(value, d, u.data() + k);
  }
  sum_rows({F.first, F.stride, kColumns}, weights, add, u, k);
}

HWY_ATTR void sum(const ModeColumns& F, const float* weights, bool add, std::span<float> u) {
  std::size_t i = 0;
  const auto rest = [&] { return ModeColumns{F.first + i * F.stride, F.stride, F.count - i}; };
  for (; i + kTogether <= F.count; i += kTogether) {
    sum_columns<kTogether>(rest(), weights + i, add || i > 0, u);
  }
  const bool more = add || i > 0;
  switch (F.count - i) {
    case 0:
      if (!more) std::fill(u.begin(), u.end(), 0.0f);
      return;
    case 1:
      return sum_columns<1>(rest(), weights + i, more, u);
    case 2:
      return sum_columns<2>(rest(), weights + i, more, u);
    case 3:
      return sum_columns<3>(rest(), weights + i, more, u);
    case 4:
      return sum_columns<4>(rest(), weights + i, more, u);
    case 5:
      return sum_columns<5>(rest(), weights + i, more, u);
    case 6:
      return sum_columns<6>(rest(), weights + i, more, u);
    default:
      return sum_columns<7>(rest(), weights + i, more, u);
  }
}

// The stress of a vertex is read as two triples, xx yy zz and xy yz zx. So even lanes hold normal
// stresses and odd lanes shear stresses, and neighbouring lanes are added at the end.
HWY_ATTR void von_mises(const float* stress, std::span<float> result) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  const auto half = hn::Set(d, 0.5f), three = hn::Set(d, 3.0f);
  const auto parts = [&](const float* s) HWY_ATTR {
    hn::VFromD<Floats> a, b, c;
    hn::LoadInterleaved3(d, s, a, b, c);
    const auto ab = hn::Sub(a, b), bc = hn::Sub(b, c), ca = hn::Sub(c, a);
    const auto normal =
        hn::Mul(half, hn::Add(hn::Add(hn::Mul(ab, ab), hn::Mul(bc, bc)), hn::Mul(ca, ca)));
    const auto shear =
        hn::Mul(three, hn::Add(hn::Add(hn::Mul(a, a), hn::Mul(b, b)), hn::Mul(c, c)));
    const auto both = hn::OddEven(shear, normal);
    return hn::Sqrt(hn::Add(both, hn::Reverse2(d, both)));
  };
  std::size_t k = 0;
  for (; k + lanes <= result.size(); k += lanes) {
    const auto low = parts(stress + 6 * k), high = parts(stress + 6 * k + 3 * lanes);
    hn::StoreU(hn::ConcatEven(d, high, low), d, result.data() + k);
  }
  plain_von_mises(stress + 6 * k, result.subspan(k));
}

HWY_ATTR void normalise(float* vectors, std::size_t count) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t k = 0;
  for (; k + lanes <= count; k += lanes) {
    hn::VFromD<Floats> x, y, z;
    hn::LoadInterleaved3(d, vectors + 3 * k, x, y, z);
    const auto length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
    const auto divisor = hn::IfThenElse(hn::Gt(length, hn::Zero(d)), length, hn::Set(d, 1.0f));
    hn::StoreInterleaved3(hn::Div(x, divisor), hn::Div(y, divisor), hn::Div(z, divisor), d,
                          vectors + 3 * k);
  }
  plain_normalise(vectors + 3 * k, count - k);
}

#endif  // HWY_SCALAR

}  // namespace palpable::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace palpable {
namespace {
HWY_EXPORT(sum);
HWY_EXPORT(von_mises);
HWY_EXPORT(normalise);

std::vector<ModeKernels> find_kernels() {
  std::vector<ModeKernels> kernels;
  for_each_simd_target(hwy::SupportedAndGeneratedTargets(), [&](const char* name) {
    kernels.push_back({name, &HWY_DYNAMIC_DISPATCH(sum), &HWY_DYNAMIC_DISPATCH(von_mises),
                       &HWY_DYNAMIC_DISPATCH(normalise)});
  });
  kernels.push_back({"plain", plain_sum, plain_von_mises, plain_normalise});
  return kernels;
}

// Initialised before main(), so that the first frame does not allocate either, and no two threads
// choose at the same time.
const std::vector<ModeKernels> kKernels = find_kernels();

}  // namespace

std::span<const ModeKernels> mode_kernels() { return kKernels; }

}  // namespace palpable
#endif
