// The loops over rows for whatever vector instructions there are, by Google Highway: this file is
// compiled once for each instruction set, and the best one is chosen when the program runs. It is
// compiled without contraction of a * b + c (CMakeLists.txt), which would differ between them.

#include "palpable/touch/row_kernels.h"

#include "palpable/base/simd_targets.h"

#include <array>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "palpable/touch/row_kernels.cpp"
// What each file of Highway needs first:
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#ifndef PALPABLE_ROW_KERNELS_ONCE
#define PALPABLE_ROW_KERNELS_ONCE
namespace palpable {
namespace {

// Halves are added to halves: the same tree for every width of vectors.
inline float sum_of(std::array<float, kRowStep> partial) {
  for (std::size_t half = kRowStep / 2; half > 0; half /= 2) {
    for (std::size_t k = 0; k < half; ++k) partial[k] += partial[k + half];
  }
  return partial[0];
}

template <class Number>
void plain_add(const Number* row, float weight, std::span<float> sum) {
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * static_cast<float>(row[k]);
}

template <class Number>
void plain_dots(const Number* rows, std::size_t count, std::span<const float> vector,
                float* result) {
  for (std::size_t i = 0; i < count; ++i) {
    const Number* row = rows + i * vector.size();
    std::array<float, kRowStep> partial{};
    for (std::size_t k = 0; k < vector.size(); ++k) {
      partial[k % kRowStep] += static_cast<float>(row[k]) * vector[k];
    }
    result[i] = sum_of(partial);
  }
}

}  // namespace
}  // namespace palpable
#endif

HWY_BEFORE_NAMESPACE();
namespace palpable::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR

using Floats = hn::CappedTag<float, kRowStep>;

HWY_ATTR inline hn::VFromD<Floats> load(const float* from) { return hn::LoadU(Floats(), from); }
HWY_ATTR inline hn::VFromD<Floats> load(const std::int16_t* from) {
  const hn::RebindToSigned<Floats> di;
  const hn::Rebind<std::int16_t, Floats> di16;
  return hn::ConvertTo(Floats(), hn::PromoteTo(di, hn::LoadU(di16, from)));
}

template <class Number>
HWY_ATTR inline void add_row(const Number* row, float weight, std::span<float> sum) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  const auto w = hn::Set(d, weight);
  for (std::size_t k = 0; k < sum.size(); k += lanes) {
    hn::StoreU(hn::Add(hn::LoadU(d, sum.data() + k), hn::Mul(w, load(row + k))), d, sum.data() + k);
  }
}

template <class Number>
HWY_ATTR inline void dot_rows(const Number* rows, std::size_t count, std::span<const float> vector,
                              float* result) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < count; ++i) {
    const Number* row = rows + i * vector.size();
    // As many as 16 lanes take: one of AVX-512, two of AVX2, four of SSE4.
    auto a = hn::Zero(d), b = a, c = a, e = a;
    std::size_t k = 0;
    for (; k < vector.size(); k += kRowStep) {
      const float* v = vector.data() + k;
      a = hn::Add(a, hn::Mul(load(row + k), hn::LoadU(d, v)));
      if (lanes < 16) b = hn::Add(b, hn::Mul(load(row + k + lanes), hn::LoadU(d, v + lanes)));
      if (lanes < 8) {
        c = hn::Add(c, hn::Mul(load(row + k + 2 * lanes), hn::LoadU(d, v + 2 * lanes)));
        e = hn::Add(e, hn::Mul(load(row + k + 3 * lanes), hn::LoadU(d, v + 3 * lanes)));
      }
    }
    alignas(64) std::array<float, kRowStep> partial{};
    hn::StoreU(a, d, partial.data());
    if (lanes < 16) hn::StoreU(b, d, partial.data() + lanes);
    if (lanes < 8) {
      hn::StoreU(c, d, partial.data() + 2 * lanes);
      hn::StoreU(e, d, partial.data() + 3 * lanes);
    }
    result[i] = sum_of(partial);
  }
}

HWY_ATTR void add(const std::int16_t* row, float weight, std::span<float> sum) {
  add_row(row, weight, sum);
}
HWY_ATTR void add_floats(const float* row, float weight, std::span<float> sum) {
  add_row(row, weight, sum);
}
HWY_ATTR void dots(const std::int16_t* rows, std::size_t count, std::span<const float> vector,
                   float* result) {
  dot_rows(rows, count, vector, result);
}
HWY_ATTR void dots_floats(const float* rows, std::size_t count, std::span<const float> vector,
                          float* result) {
  dot_rows(rows, count, vector, result);
}

#else

void add(const std::int16_t* row, float weight, std::span<float> sum) {
  plain_add(row, weight, sum);
}
void add_floats(const float* row, float weight, std::span<float> sum) {
  plain_add(row, weight, sum);
}
void dots(const std::int16_t* rows, std::size_t count, std::span<const float> vector,
          float* result) {
  plain_dots(rows, count, vector, result);
}
void dots_floats(const float* rows, std::size_t count, std::span<const float> vector,
                 float* result) {
  plain_dots(rows, count, vector, result);
}

#endif  // HWY_SCALAR

}  // namespace palpable::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace palpable {
namespace {
HWY_EXPORT(add);
HWY_EXPORT(add_floats);
HWY_EXPORT(dots);
HWY_EXPORT(dots_floats);

std::vector<RowKernels> find_kernels() {
  std::vector<RowKernels> kernels;
  for_each_simd_target(hwy::SupportedAndGeneratedTargets(), [&](const char* name) {
    kernels.push_back({name, &HWY_DYNAMIC_DISPATCH(add), &HWY_DYNAMIC_DISPATCH(add_floats),
                       &HWY_DYNAMIC_DISPATCH(dots), &HWY_DYNAMIC_DISPATCH(dots_floats)});
  });
  kernels.push_back({"plain", plain_add<std::int16_t>, plain_add<float>, plain_dots<std::int16_t>,
                     plain_dots<float>});
  return kernels;
}

// Before main(): the first frame, too, allocates nothing, and no two threads choose at once.
const std::vector<RowKernels> kKernels = find_kernels();

}  // namespace

std::span<const RowKernels> row_kernels() { return kKernels; }

}  // namespace palpable
#endif
