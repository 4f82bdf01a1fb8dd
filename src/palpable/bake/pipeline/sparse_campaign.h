/// @file
/// Sparse PGD of a campaign: learnt from a part of its snapshots, measured on all of them.
///
///   N  values of a snapshot   S  sites   L  solved levels   m  modes
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/separate/sparse_pgd.h"
#include "palpable/common/base/progress.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

struct SparseCampaignSettings {
  double part = 0.3;       ///< ratio of snapshots to learn from, drawn at random
  std::uint64_t seed = 1;  ///< of the draw
  SparseSettings sparse = {};
};

/// Relative L2 errors of some snapshots, over the volume.
struct SnapshotErrors {
  int count = 0;
  double pooled = 0;             ///< of all together
  double median = 0, worst = 0;  ///< the middle and the largest, each against its own norm
};

/// The parameters that identify the pressed site.
///   a  axes
struct SitePlaces {
  bool quantities = false;  ///< the position is continuous, not a choice among sites
  std::vector<SparseAxis> axes;
  Eigen::MatrixXd points;  ///< (a x S)
};

/// Where all sites are pressed in the same direction and lie in a plane or on a line along the
/// body's axes, the position is a continuous quantity: the coordinates, m, in which the sites
/// differ. Otherwise it is a choice among the sites.
[[nodiscard]] SitePlaces site_places(const StoreContent& content);

struct SparseCampaign {
  /// Over the axes of `places`, and the load level last; F (N x m).
  SparsePgd model;
  SitePlaces places;
  /// The model's functions at all sites (S x m), products of those of their coordinates, and at all
  /// solved levels (L x m).
  Eigen::MatrixXd site_functions, level_functions;
  int trained_on = 0;
  SnapshotErrors all, unseen;  ///< of all snapshots, and of those that were not learnt from
  Eigen::VectorXd errors;      ///< (S L) each against its own norm, level fastest; 0 of zero
};

/// Learns a model that is zero at level 0. Where sites are choices, at least one snapshot of each
/// site is learnt from. Works in the POD coordinates of the training snapshots. Memory: the
/// training snapshots, twice.
/// @param point  of the parameters beyond site and level; complete
/// @throws Error if the part is too small to learn from, or leaves no snapshot to test
[[nodiscard]] SparseCampaign sparse_campaign(const SnapshotStore& store, int point,
                                             const StoredField& field,
                                             const SparseCampaignSettings& settings,
                                             const Progress& progress = {});

}  // namespace palpable
