#include "bench/bake/machine_rates.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/cpu_time.h"

#include <algorithm>
#include <cstring>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace palpable {
namespace {

// Independent chains of operations: eight hide the latency of multiply-adds on two ports.
constexpr int kChains = 8;

#if defined(__x86_64__)
[[gnu::target("avx512f"), gnu::noinline]] float spin_avx512(long steps) {
  __m512 x[kChains];
  for (int i = 0; i < kChains; ++i) x[i] = _mm512_set1_ps(static_cast<float>(i));
  const __m512 m = _mm512_set1_ps(0.999F), a = _mm512_set1_ps(0.1F);
  for (long k = 0; k < steps; ++k) {
#pragma GCC unroll 8
    for (int i = 0; i < kChains; ++i) x[i] = _mm512_fmadd_ps(x[i], m, a);
  }
  for (int i = 1; i < kChains; ++i) x[0] = _mm512_add_ps(x[0], x[i]);
  return _mm512_cvtss_f32(x[0]);
}

[[gnu::target("avx2,fma"), gnu::noinline]] float spin_avx2(long steps) {
  __m256 x[kChains];
  for (int i = 0; i < kChains; ++i) x[i] = _mm256_set1_ps(static_cast<float>(i));
  const __m256 m = _mm256_set1_ps(0.999F), a = _mm256_set1_ps(0.1F);
  for (long k = 0; k < steps; ++k) {
#pragma GCC unroll 8
    for (int i = 0; i < kChains; ++i) x[i] = _mm256_fmadd_ps(x[i], m, a);
  }
  for (int i = 1; i < kChains; ++i) x[0] = _mm256_add_ps(x[0], x[i]);
  return _mm256_cvtss_f32(x[0]);
}
#endif

[[gnu::noinline]] float spin_plain(long steps) {
  float x[4 * kChains];
  for (int i = 0; i < 4 * kChains; ++i) x[i] = static_cast<float>(i);
  for (long k = 0; k < steps; ++k) {
#pragma GCC unroll 32
    for (float& value : x) value = value * 0.999F + 0.1F;
  }
  float sum = 0;
  for (const float value : x) sum += value;
  return sum;
}

}  // namespace

MachineRates measure_machine(std::size_t copied_bytes) {
  PALPABLE_EXPECT(copied_bytes > 0, "something to copy");
  MachineRates rates;
  std::vector<char> from(copied_bytes, 1), to(copied_bytes, 2);
  constexpr int kRepeats = 5;
  for (int r = 0; r < kRepeats; ++r) {
    from[0] = static_cast<char>(r);
    const double begin = process_cpu_seconds();
    std::memcpy(to.data(), from.data(), copied_bytes);
    rates.bytes_per_s = std::max(rates.bytes_per_s, 2.0 * static_cast<double>(copied_bytes) /
                                                        (process_cpu_seconds() - begin));
    // Reading the result keeps the compiler from removing the copy.
    if (to[0] != from[0]) rates.bytes_per_s = 0;
  }

  float (*spin)(long) = spin_plain;
  int lanes = 4;
  rates.vectors = "SSE2";
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) {
    spin = spin_avx512, lanes = 16, rates.vectors = "AVX-512";
  } else if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    spin = spin_avx2, lanes = 8, rates.vectors = "AVX2";
  }
#endif
  constexpr long kSteps = 5'000'000;
  for (int r = 0; r < kRepeats; ++r) {
    const double begin = process_cpu_seconds();
    volatile float result = spin(kSteps);
    static_cast<void>(result);
    rates.flops_per_s = std::max(rates.flops_per_s,
                                 2.0 * lanes * kChains * kSteps / (process_cpu_seconds() - begin));
  }
  return rates;
}

}  // namespace palpable
