/// @file
/// From a body's description to a store full of its snapshots: mesh, plan, campaign.
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

namespace palpable {

struct FillSettings {
  int threads = 0;  ///< 0: one per core
  /// Folder of the snapshots, made if absent; what is valid there is not solved again.
  std::filesystem::path store = {};
  FeSolver solver = FeSolver::kOwn;
  int shard = 0, shards = 1;  ///< as CampaignSettings
  /// A complete campaign of the same description: then `store` gets the levels half way between its
  /// levels, (m + 1/2) / L, of the same loads, solved afresh: what a reduced body was not made
  /// from.
  const SnapshotStore* held_out_of = nullptr;
};

struct FilledStore {
  SnapshotStore store;
  CampaignPlan plan;  ///< what was solved
  CampaignReport campaign;
  StageTimes wall;  ///< ms by the clock on the wall: mesh, campaign
  /// Snapshots of another description that were in the folder; on the leader of the crew.
  std::optional<SetAside> set_aside = {};
  /// Keeps other campaigns out of the folder; on the leader of the crew.
  std::unique_ptr<FolderLock> held = {};
};

/// What is known of a body before anything is solved. Levels, keys, and where the snapshots come
/// from are left to the caller.
[[nodiscard]] StoreContent content_of(const BodyDescription& description,
                                      const BodyProblem& problem);

/// Meshes the body and solves its campaign into settings.store; what is there of another campaign
/// is set aside first.
/// @pre settings.store is not empty
/// @throws Error for everything in the world that is not as hoped: mesh, supports, loads, disk
[[nodiscard]] FilledStore fill_store(const BodyDescription& description,
                                     const FillSettings& settings, Crew& crew,
                                     const Progress& progress = {});

}  // namespace palpable
