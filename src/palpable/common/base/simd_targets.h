/// @file
/// Collects functions that are compiled once for each instruction set (Google Highway). Only
/// modules that link Highway can use it; this file contains only templates.
#pragma once

#include <cstdint>
#include <hwy/targets.h>
#include <vector>
#if HWY_ARCH_X86
#include <cpuid.h>
#endif

namespace palpable {

/// Whether this processor runs what the compiler may emit for a target of Highway. Highway 1.0.3
/// compiles AVX3_DL with the instructions of AVX-VNNI, which it does not look for at run time: a
/// processor of Intel's Ice Lake generation has AVX-512 VNNI without them, and Clang's `vpdpwssd`
/// aborts the program there (Highway's pull request 1176).
[[nodiscard]] inline bool runs_here([[maybe_unused]] std::int64_t target) {
#if HWY_ARCH_X86
  if (target != HWY_AVX3_DL) return true;
  constexpr unsigned kAvxVnni = 1U << 4;  // in EAX of leaf 7, subleaf 1
  unsigned a = 0, b = 0, c = 0, d = 0;
  return __get_cpuid_count(7, 1, &a, &b, &c, &d) != 0 && (a & kAvxVnni) != 0;
#else
  return true;
#endif
}

/// Calls `visit(name)` once for each of `targets` that is a set of vector instructions and
/// runs_here(), in their order. During the call HWY_DYNAMIC_DISPATCH refers to that set's
/// functions; `name` is Highway's name of the set. Afterwards Highway's choice, which is global, is
/// restored.
///
/// Call it in the initialiser of a constant at namespace scope, which runs before main(): then no
/// frame pays for it, and no two threads make the choice at the same time, which Highway does not
/// guard against.
///
/// @param targets  hwy::SupportedAndGeneratedTargets(): the best first
template <class Visit>
void for_each_simd_target(const std::vector<std::int64_t>& targets, const Visit& visit) {
  for (const std::int64_t target : targets) {
    // For HWY_SCALAR callers have plain loops of their own.
    if (target == HWY_SCALAR || !runs_here(target)) continue;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    visit(hwy::TargetName(target));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace palpable
