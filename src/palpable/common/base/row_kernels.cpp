// The loops over rows for all sets of vector instructions, by Google Highway: this file is compiled
// once for each instruction set, and the best one is chosen when the program runs. It is compiled
// without contraction of a * b + c (CMakeLists.txt), which would give results that differ between
// the instruction sets.

#include "palpable/common/base/row_kernels.h"

#include "palpable/common/base/simd_targets.h"

#include <array>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "palpable/common/base/row_kernels.cpp"
// Every file that uses Highway begins with these includes:
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#ifndef PALPABLE_ROW_KERNELS_ONCE
#define PALPABLE_ROW_KERNELS_ONCE
namespace palpable {
namespace {

// Adds one half of the sums to the other until one is left: the same tree for every vector width.
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
void plain_add_rows(const Number* rows, std::size_t stride, std::span<const float> weights,
                    std::span<float> sum) {
  for (std::size_t i = 0; i < weights.size(); ++i) plain_add(rows + i * stride, weights[i], sum);
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
  auto wide = hn::PromoteTo(di, hn::LoadU(di16, from));
#if HWY_ARCH_WASM
  // Without this, Clang 14 converts number by number.
  asm("" : "+r"(wide.raw));
#endif
  return hn::ConvertTo(Floats(), wide);
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

// Four vectors at a time, whose sums stay in registers over all rows.
template <class Number>
HWY_ATTR inline void add_many(const Number* rows, std::size_t stride,
                              std::span<const float> weights, std::span<float> sum) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t k = 0;
  for (; k + 4 * lanes <= sum.size(); k += 4 * lanes) {
    float* to = sum.data() + k;
    auto a = hn::LoadU(d, to), b = hn::LoadU(d, to + lanes), c = hn::LoadU(d, to + 2 * lanes),
         e = hn::LoadU(d, to + 3 * lanes);
    const Number* row = rows + k;
    for (const float weight : weights) {
      const auto w = hn::Set(d, weight);
      a = hn::Add(a, hn::Mul(w, load(row)));
      b = hn::Add(b, hn::Mul(w, load(row + lanes)));
      c = hn::Add(c, hn::Mul(w, load(row + 2 * lanes)));
      e = hn::Add(e, hn::Mul(w, load(row + 3 * lanes)));
      row += stride;
    }
    hn::StoreU(a, d, to);
    hn::StoreU(b, d, to + lanes);
    hn::StoreU(c, d, to + 2 * lanes);
    hn::StoreU(e, d, to + 3 * lanes);
  }
  for (; k < sum.size(); k += lanes) {
    auto a = hn::LoadU(d, sum.data() + k);
    const Number* row = rows + k;
    for (const float weight : weights) {
      a = hn::Add(a, hn::Mul(hn::Set(d, weight), load(row)));
      row += stride;
    }
    hn::StoreU(a, d, sum.data() + k);
  }
}

// Writes the 16 partial sums of a row's dot product to `four`, after one half has been added to the
// other until four are left.
template <class Number>
HWY_ATTR inline void dot_to_four(const Number* row, std::span<const float> vector, float* four) {
  const Floats d;
  const hn::CappedTag<float, 4> d4;
  const std::size_t lanes = hn::Lanes(d);
  // The vectors that hold 16 lanes: one with AVX-512, two with AVX2, four with SSE4.
  auto a = hn::Zero(d), b = a, c = a, e = a;
  for (std::size_t k = 0; k < vector.size(); k += kRowStep) {
    const float* v = vector.data() + k;
    a = hn::Add(a, hn::Mul(load(row + k), hn::LoadU(d, v)));
    if (lanes < 16) b = hn::Add(b, hn::Mul(load(row + k + lanes), hn::LoadU(d, v + lanes)));
    if (lanes < 8) {
      c = hn::Add(c, hn::Mul(load(row + k + 2 * lanes), hn::LoadU(d, v + 2 * lanes)));
      e = hn::Add(e, hn::Mul(load(row + k + 3 * lanes), hn::LoadU(d, v + 3 * lanes)));
    }
  }
  if (lanes == 4) {
    hn::StoreU(hn::Add(hn::Add(a, c), hn::Add(b, e)), d, four);
    return;
  }
  alignas(64) std::array<float, kRowStep> partial;
  if (lanes == 8) a = hn::Add(a, b);
  hn::StoreU(a, d, partial.data());
  auto half = hn::LoadU(d4, partial.data()), other = hn::LoadU(d4, partial.data() + 4);
  if (lanes == 16) {
    half = hn::Add(half, hn::LoadU(d4, partial.data() + 8));
    other = hn::Add(other, hn::LoadU(d4, partial.data() + 12));
  }
  hn::StoreU(hn::Add(half, other), d4, four);
}

template <class Number>
HWY_ATTR inline void dot_rows(const Number* rows, std::size_t count, std::span<const float> vector,
                              float* result) {
  const hn::CappedTag<float, 4> d4;
  alignas(16) std::array<float, 16> fours{};
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4) {
    for (std::size_t k = 0; k < 4; ++k)
      dot_to_four(rows + (i + k) * vector.size(), vector, fours.data() + 4 * k);
    hn::VFromD<decltype(d4)> p0, p1, p2, p3;
    hn::LoadInterleaved4(d4, fours.data(), p0, p1, p2, p3);
    hn::StoreU(hn::Add(hn::Add(p0, p2), hn::Add(p1, p3)), d4, result + i);
  }
  for (; i < count; ++i) {
    const float* four = fours.data();
    dot_to_four(rows + i * vector.size(), vector, fours.data());
    result[i] = (four[0] + four[2]) + (four[1] + four[3]);
  }
}

HWY_ATTR void add(const std::int16_t* row, float weight, std::span<float> sum) {
  add_row(row, weight, sum);
}
HWY_ATTR void add_floats(const float* row, float weight, std::span<float> sum) {
  add_row(row, weight, sum);
}
HWY_ATTR void add_rows(const std::int16_t* rows, std::size_t stride, std::span<const float> weights,
                       std::span<float> sum) {
  add_many(rows, stride, weights, sum);
}
HWY_ATTR void add_float_rows(const float* rows, std::size_t stride, std::span<const float> weights,
                             std::span<float> sum) {
  add_many(rows, stride, weights, sum);
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
void add_rows(const std::int16_t* rows, std::size_t stride, std::span<const float> weights,
              std::span<float> sum) {
  plain_add_rows(rows, stride, weights, sum);
}
void add_float_rows(const float* rows, std::size_t stride, std::span<const float> weights,
                    std::span<float> sum) {
  plain_add_rows(rows, stride, weights, sum);
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
HWY_EXPORT(add_rows);
HWY_EXPORT(add_float_rows);
HWY_EXPORT(dots);
HWY_EXPORT(dots_floats);

std::vector<RowKernels> find_kernels() {
  std::vector<RowKernels> kernels;
  for_each_simd_target(hwy::SupportedAndGeneratedTargets(), [&](const char* name) {
    kernels.push_back({name, &HWY_DYNAMIC_DISPATCH(add), &HWY_DYNAMIC_DISPATCH(add_floats),
                       &HWY_DYNAMIC_DISPATCH(add_rows), &HWY_DYNAMIC_DISPATCH(add_float_rows),
                       &HWY_DYNAMIC_DISPATCH(dots), &HWY_DYNAMIC_DISPATCH(dots_floats)});
  });
  kernels.push_back({"plain", plain_add<std::int16_t>, plain_add<float>,
                     plain_add_rows<std::int16_t>, plain_add_rows<float>, plain_dots<std::int16_t>,
                     plain_dots<float>});
  return kernels;
}

// Initialised before main(), so that the first frame does not allocate either, and no two threads
// choose at the same time.
const std::vector<RowKernels> kKernels = find_kernels();

}  // namespace

std::span<const RowKernels> row_kernels() { return kKernels; }

}  // namespace palpable
#endif
