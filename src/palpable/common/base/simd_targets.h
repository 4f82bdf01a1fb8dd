/// @file
/// Lists, before main(), loops that are compiled once for each instruction set (Google Highway).
/// Only modules that link Highway can use it; this file holds nothing but templates.
#pragma once

#include <cstdint>
#include <hwy/targets.h>
#include <vector>

namespace palpable {

/// Calls `visit(name)` once for each of `targets` that is a set of vector instructions, in their
/// order. During the call HWY_DYNAMIC_DISPATCH points at that set's functions; `name` is what
/// Highway calls it. Afterwards Highway's choice, which is one for the whole program, is as it was.
///
/// Call it where a constant of a file is initialised: then no frame pays for the choice, and no two
/// threads make it at once, which Highway does not guard against.
///
/// @param targets  hwy::SupportedAndGeneratedTargets(): the best first
template <class Visit>
void for_each_simd_target(const std::vector<std::int64_t>& targets, const Visit& visit) {
  for (const std::int64_t target : targets) {
    if (target == HWY_SCALAR) continue;  // callers have plain loops of their own
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    visit(hwy::TargetName(target));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace palpable
