/// @file
/// Collects functions that are compiled once for each instruction set (Google Highway). Only
/// modules that link Highway can use it; this file contains only templates.
#pragma once

#include <cstdint>
#include <hwy/targets.h>
#include <vector>

namespace palpable {

/// Calls `visit(name)` once for each of `targets` that is a set of vector instructions, in their
/// order. During the call HWY_DYNAMIC_DISPATCH refers to that set's functions; `name` is Highway's
/// name of the set. Afterwards Highway's choice, which is global, is restored.
///
/// Call it in the initialiser of a constant at namespace scope, which runs before main(): then no
/// frame pays for it, and no two threads make the choice at the same time, which Highway does not
/// guard against.
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
