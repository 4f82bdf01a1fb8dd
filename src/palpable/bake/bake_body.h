/// @file
/// The whole bake: description -> mesh -> campaign in a store -> reduction -> body.
#pragma once

#include "palpable/base/progress.h"
#include "palpable/base/stage_clock.h"
#include "palpable/campaign/campaign.h"
#include "palpable/campaign/crew.h"
#include "palpable/campaign/snapshot_store.h"
#include "palpable/describe/body_description.h"
#include "palpable/describe/body_mesh.h"
#include "palpable/describe/body_problem.h"
#include "palpable/reduced/reduced_body.h"
#include "palpable/separate/reduction.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace palpable {

struct BakeSettings {
  int threads = 0;           ///< 0: one per core
  std::string version;       ///< of the program, for the provenance
  std::string command_line;  ///< likewise
  /// Folder of the snapshots, made if absent; what is valid there is not solved again. Empty: a
  /// temporary one, which is removed.
  std::filesystem::path store = {};
  std::string solver = "own";  ///< or "calculix"
  int shard = 0, shards = 1;   ///< as CampaignSettings
  /// A complete campaign of the same description: then `store` gets the levels half way between its
  /// levels, (m + 1/2) / L, of the same loads, solved afresh: what a reduced body was not made
  /// from.
  const SnapshotStore* held_out_of = nullptr;
};

/// What to make of a store.
struct ReduceSettings {
  std::optional<ReductionMethod> method = {};  ///< none: as the body's description says
  /// None: as the description says, or of another method than its: default_tolerance().
  std::optional<double> tolerance = {};
  std::optional<int> max_modes = {};   ///< none: as the description says
  std::optional<bool> own_norms = {};  ///< ReductionSettings::weight_snapshots; likewise
  /// Values of parameters beyond site and level. Empty: they stay free, and the body holds them all
  /// (ReducedBody::further). Otherwise it holds one value of each; of one that is not named, that
  /// in the middle of its list.
  std::map<std::string, double> at = {};
  bool volume = false;  ///< all nodes too, beside those of the boundary: ReducedBody::volume
  std::string version = {}, command_line = {};  ///< for the provenance
};

/// How one field was reduced, and how much of it was lost.
struct ReductionReport {
  ReductionMethod method = ReductionMethod::kPerSite;
  int modes = 0;                ///< with kPerSite the most of one site
  int columns = 0;              ///< modes that the body file holds, of all blocks
  double bytes = 0;             ///< of those, boundary only, single precision
  Eigen::VectorXd errors = {};  ///< after 1, 2, ... modes (see Reduction)
  std::vector<int> ranks = {};  ///< kHosvd
  std::optional<double> bound = {};
  bool reached = true;  ///< the tolerance was met
  double pooled = 0;    ///< of the result, over the volume
  double median = 0;    ///< error of the middle snapshot in its own norm, over the volume
  double worst = 0;     ///< of the worst one
  /// Largest difference of the body as the live half evaluates it (single precision, boundary) from
  /// the snapshots there, relative to the largest value of all. Contains the reduction error.
  double evaluated_worst = 0;
};

struct BakeReport {
  int nodes = 0, tets = 0, vertices = 0, triangles = 0;
  std::vector<SiteOutcome> outcomes;
  ReductionReport displacement, stress;
  std::string held_out = {};       ///< one line, of who has compared; empty: nobody
  std::string between_sites = {};  ///< one line; empty: the store has no linear responses
  StageTimes wall;                 ///< ms by the clock on the wall: mesh, campaign, reduce
  StageTimes threads;              ///< ms of the campaign's parts, summed over threads
};

struct BakedBody {
  ReducedBody body;
  BakeReport report;
};

/// What is known of a body before anything is solved; levels, keys, and where the snapshots come
/// from are left to the caller.
[[nodiscard]] StoreContent content_of(const BodyDescription& description,
                                      const BodyProblem& problem);

/// Meshes, and solves the campaign into settings.store.
struct FilledStore {
  SnapshotStore store;
  CampaignReport campaign;
  StageTimes wall;  ///< ms: mesh, campaign
};

/// @pre settings.store is not empty
/// @throws Error for everything in the world that is not as hoped: mesh, supports, loads, disk
[[nodiscard]] FilledStore fill_store(const BodyDescription& description,
                                     const BakeSettings& settings, Crew& crew,
                                     const Progress& progress = {});

/// The point that ReduceSettings::at means. @throws Error if `at` names what the store does not
/// have
[[nodiscard]] int point_of(const StoreContent& content, const std::map<std::string, double>& at);

/// Reduces the snapshots of a complete store to a body, boundary only unless settings.volume. Reads
/// them in blocks: memory is 200 MB, 24 bytes for each pair of snapshots and what the modes take.
/// What a touch between sites costs is stated where the store's linear responses tell.
/// @throws Error if a unit is missing or damaged, or `at` names what the store does not have
[[nodiscard]] BakedBody reduce_store(const SnapshotStore& store, const ReduceSettings& settings,
                                     const Progress& progress = {});

/// Both. Deterministic, whatever the number of threads.
[[nodiscard]] BakedBody bake_body(const BodyDescription& description, const BakeSettings& settings,
                                  const Progress& progress = {});

}  // namespace palpable
