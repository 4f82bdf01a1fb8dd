/// @file
/// The paper's numbers beside those that were measured here.
#pragma once

#include "palpable/bake/reproduce/paper_plan.h"

#include <string>
#include <vector>

namespace palpable {

struct PaperNumber {
  std::string what, paper, here, remark;
};

/// Of the plan's examples: meshes, positions, times, modes and errors, frame rates, hardware.
/// @param list  that has run the plan: how long its bakes took
/// @throws Error when a body file or a run's live.json cannot be read
[[nodiscard]] std::vector<PaperNumber> paper_numbers(const PaperPlan& plan, const StepList& list);

}  // namespace palpable
