/// @file
/// Computes the snapshots of a described body into a store: mesh, plan, campaign.
#pragma once

#include "palpable/bake/campaign/campaign.h"
#include "palpable/bake/campaign/crew.h"
#include "palpable/bake/campaign/set_aside.h"
#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/common/base/folder_lock.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/base/stage_clock.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct FillSettings {
  int threads = 0;  ///< 0: one per core
  /// Folder of the snapshots, created if absent; valid snapshots in it are not solved again.
  std::filesystem::path store = {};
  FeSolver solver = FeSolver::kOwn;
  int shard = 0, shards = 1;  ///< as CampaignSettings
  /// A complete campaign of the same description. If given, `store` gets held-out snapshots: levels
  /// half way between those of the campaign, (m + 1/2) / L, under the same loads. They measure the
  /// error of a body that was reduced from the campaign.
  const SnapshotStore* held_out_of = nullptr;
};

struct FilledStore {
  SnapshotStore store;
  CampaignPlan plan;  ///< what was solved
  CampaignReport campaign;
  StageTimes wall;  ///< wall time, ms: mesh, campaign
  /// Snapshots of another description that were in the folder; set in the leader only.
  std::optional<SetAside> set_aside = {};
  /// Lock that keeps other campaigns out of the folder; held by the leader only.
  std::unique_ptr<FolderLock> held = {};
};

/// The materials of a description as a line, which snapshots and body files keep.
[[nodiscard]] std::string materials_line(const BodyDescription& description);

/// The parameters beyond site and level of a description, as its store has them.
[[nodiscard]] std::vector<StoredParameter> stored_parameters(const BodyDescription& description);

/// The part of a store's content that is known before anything is solved. The caller adds levels,
/// keys and the provenance of the snapshots.
[[nodiscard]] StoreContent content_of(const BodyDescription& description,
                                      const BodyProblem& problem);

/// Meshes the body and solves its campaign into settings.store; snapshots of another campaign in
/// that folder are set aside first.
/// @pre settings.store is not empty
/// @throws Error for a mesh, supports or loads that cannot be used, and when the disk cannot be
///         written
[[nodiscard]] FilledStore fill_store(const BodyDescription& description,
                                     const FillSettings& settings, Crew& crew,
                                     const Progress& progress = {});

}  // namespace palpable
