/// @file
/// CP-ALS: the tensor as a sum of a given number of separated modes, all at once (canonical
/// polyadic decomposition by alternating least squares; Carroll and Chang 1970, Harshman 1970).
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"
#include "palpable/common/base/progress.h"

namespace palpable {

struct CpSettings {
  int max_sweeps = 60;            ///< of alternating least squares at a number of modes
  double sweep_tolerance = 1e-3;  ///< sweeps end when the error falls by less than this part
};

/// The least number of modes found to meet the goal. Starts from the greedy mode (greedy_pgd.h) at
/// each number of modes; sweeps (improve_all_functions) are spent in full where the goal is within
/// a factor of two, and one each before. The best rank-m approximation may not exist for p >= 2:
/// then modes grow against each other and sweeps stop helping ("swamps"), near 1e-5 on a bunny.
/// @throws as greedy_pgd()
[[nodiscard]] Separation cp_als(const SnapshotTensor& snapshots, const ReductionGoal& goal,
                                const CpSettings& settings = {}, const Progress& progress = {});

}  // namespace palpable
