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
  double part = 0.3;       ///< of the snapshots (site, level), drawn at random, to learn from
  std::uint64_t seed = 1;  ///< of the draw
  SparseSettings sparse = {};
};

/// Relative L2 errors of some snapshots, over the volume.
struct SnapshotErrors {
  int count = 0;
  double pooled = 0;             ///< of all together
  double median = 0, worst = 0;  ///< the middle and the largest, each against its own norm
};

/// The parameters that say which site is pressed.
///   a  axes
struct SitePlaces {
  bool quantities = false;
  std::vector<SparseAxis> axes;
  Eigen::MatrixXd points;  ///< (a x S)
};

/// Where all sites are pressed in one direction and lie in a plane or on a line along the body's
/// axes, the place is a quantity: those coordinates, m, that differ. Else it is a choice among the
/// sites.
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
  Eigen::VectorXd errors;      ///< (S L) of each against its own norm, level fastest; 0 of zero
};

/// At level 0 the model is at rest. Where sites are choices each of them has a snapshot among those
/// that are learnt from. Works in the POD coordinates of the training snapshots. Memory: those,
/// twice.
/// @param point  of the parameters beyond site and level; complete
/// @throws Error if the part is too small to learn from, or leaves nothing to be asked about
[[nodiscard]] SparseCampaign sparse_campaign(const SnapshotStore& store, int point,
                                             const StoredField& field,
                                             const SparseCampaignSettings& settings,
                                             const Progress& progress = {});

}  // namespace palpable
