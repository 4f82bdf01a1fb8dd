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

/// The numbers of the plan's examples: meshes, positions, times, modes and errors, frame rates,
/// hardware.
/// @param list  the one that has run the plan; gives the durations of its bakes
/// @throws Error when a body file or a run's live.json cannot be read
[[nodiscard]] std::vector<PaperNumber> paper_numbers(const PaperPlan& plan, const StepList& list);

}  // namespace palpable
