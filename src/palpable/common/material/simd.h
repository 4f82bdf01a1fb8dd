/// @file
/// Finds which vector instructions the processor has, and runs loops with them: loops over packs of
/// eight numbers, such as the laws of the materials, in the compilers' own vector types. Loops
/// whose width is the processor's are written with Highway instead (base/simd_targets.h).
#pragma once

namespace palpable {

/// Sets of vector instructions. All levels give the same numbers up to rounding.
enum class SimdLevel { kPlain, kAvx2, kAvx512 };

/// The widest set that this processor has.
[[nodiscard]] inline SimdLevel best_simd_level() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    return SimdLevel::kAvx512;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return SimdLevel::kAvx2;
#endif
  return SimdLevel::kPlain;
}

/// run_at() calls Pass::run(arguments...), compiled for `level`. Pass::run and every function that
/// it calls must be forced inline: a function that is not inlined is compiled only for the
/// instructions that every processor has.
template <class Pass, class... Arguments>
auto run_plain(Arguments&... arguments) {
  return Pass::run(arguments...);
}
#ifdef __x86_64__
template <class Pass, class... Arguments>
[[gnu::target("avx2,fma")]] auto run_avx2(Arguments&... arguments) {
  return Pass::run(arguments...);
}
template <class Pass, class... Arguments>
[[gnu::target("avx512f,avx512dq,avx512vl,avx2,fma")]] auto run_avx512(Arguments&... arguments) {
  return Pass::run(arguments...);
}
#endif
template <class Pass, class... Arguments>
auto run_at(SimdLevel level, Arguments&... arguments) {
#ifdef __x86_64__
  if (level == SimdLevel::kAvx512) return run_avx512<Pass>(arguments...);
  if (level == SimdLevel::kAvx2) return run_avx2<Pass>(arguments...);
#endif
  return run_plain<Pass>(arguments...);
}
/// The same without the plain version, which is then not compiled. @param level  above kPlain
template <class Pass, class... Arguments>
auto run_with_avx(SimdLevel level, Arguments&... arguments) {
#ifdef __x86_64__
  if (level == SimdLevel::kAvx512) return run_avx512<Pass>(arguments...);
  return run_avx2<Pass>(arguments...);
#else
  return run_at<Pass>(level, arguments...);
#endif
}

/// The function that run_at() calls for `level`, for passes that are called from another one: they
/// are compiled once for each level, and not again inside each of their callers.
/// @tparam Arguments  of Pass::run, without the references
template <class Pass, class... Arguments>
auto function_at(SimdLevel level) -> decltype(&run_plain<Pass, Arguments...>) {
#ifdef __x86_64__
  if (level == SimdLevel::kAvx512) return &run_avx512<Pass, Arguments...>;
  if (level == SimdLevel::kAvx2) return &run_avx2<Pass, Arguments...>;
#endif
  return &run_plain<Pass, Arguments...>;
}

}  // namespace palpable
