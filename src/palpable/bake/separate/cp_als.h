/// @file
/// CP-ALS: fits a given number of separated modes to the tensor, all at once (canonical polyadic
/// decomposition by alternating least squares; Carroll and Chang 1970, Harshman 1970).
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"
#include "palpable/common/base/progress.h"

namespace palpable {

struct CpSettings {
  int max_sweeps = 60;            ///< of alternating least squares for each number of modes
  double sweep_tolerance = 1e-3;  ///< sweeps end when one lowers the error by less than this share
};

/// Adds modes until the goal is met. Each new mode starts as the greedy one (greedy_pgd.h) and is
/// followed by sweeps over all modes (GreedyPgd::improve()): up to max_sweeps of them when the
/// error is within a factor of two of the goal or no further mode is allowed, otherwise one. For
/// p >= 2 a best rank-m approximation need not exist: then modes grow against each other and sweeps
/// stop helping ("swamps"), near an error of 1e-5 on a bunny.
/// @throws as greedy_pgd()
[[nodiscard]] Separation cp_als(const SnapshotTensor& snapshots, const ReductionGoal& goal,
                                const CpSettings& settings = {}, const Progress& progress = {});

}  // namespace palpable
