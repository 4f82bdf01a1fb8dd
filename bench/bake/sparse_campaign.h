/// @file
/// Sparse PGD trained on a part of a campaign whose sites lie along a face, and what it says about
/// the rest: the place of the load is a quantity there, and not a choice.
#pragma once

#include "palpable/base/progress.h"
#include "palpable/campaign/snapshot_store.h"
#include "palpable/separate/sparse_pgd.h"

#include <cstdint>

namespace palpable {

struct SparseCampaignSettings {
  double part = 0.3;       ///< of the snapshots (site, level), drawn at random, to learn from
  std::uint64_t seed = 1;  ///< of the draw
  SparseSettings sparse = {};
};

struct SparseCampaign {
  /// Over the site's x, its y, and the load level; F (3N x m) m.
  SparsePgd model;
  int samples = 0, trained_on = 0;
  /// Relative L2 error over the volume, pooled over the snapshots that were not learnt from; the
  /// middle and the largest of theirs, each in its own norm.
  double held_out = 0, held_out_median = 0, held_out_worst = 0;
};

/// Displacement, in the body frame; at level 0 the model is at rest. Works in the POD coordinates
/// of the training snapshots. Memory: those, twice.
/// @throws Error if the store is not complete or has no displacement
[[nodiscard]] SparseCampaign sparse_campaign(const SnapshotStore& store,
                                             const SparseCampaignSettings& settings,
                                             const Progress& progress = {});

}  // namespace palpable
