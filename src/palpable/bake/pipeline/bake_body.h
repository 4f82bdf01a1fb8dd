/// @file
/// The whole bake: description -> mesh -> campaign in a store -> reduction -> body.
#pragma once

#include "palpable/bake/campaign/fill_store.h"
#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/pipeline/sparse_campaign.h"
#include "palpable/bake/separate/reduction.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/base/stage_clock.h"
#include "palpable/common/reduced/reduced_body.h"

#include <map>
#include <optional>
#include <string>

namespace palpable {

struct BakeSettings {
  int threads = 0;           ///< 0: one per core
  std::string version;       ///< of the program, for the provenance
  std::string command_line;  ///< likewise
};

/// What to make of a store.
struct ReduceSettings {
  std::optional<ReductionMethod> method = {};  ///< none: as the body's description says
  /// None: as the description says, or of another method than its: default_tolerance().
  std::optional<double> tolerance = {};
  std::optional<int> max_modes = {};   ///< none: as the description says
  std::optional<bool> own_norms = {};  ///< ReductionSettings::weight_snapshots; likewise
  /// Sparse PGD, which learns from a part of the snapshots, in the place of a method for the whole
  /// table; takes neither tolerance nor own_norms.
  std::optional<SparseCampaignSettings> sparse = {};
  /// Values of parameters beyond site and level. Empty: they stay free, and the body holds them all
  /// (ReducedBody::further). Otherwise it holds one value of each; of one that is not named, that
  /// in the middle of its list.
  std::map<std::string, double> at = {};
  bool volume = false;  ///< all nodes too, beside those of the boundary: ReducedBody::volume
  std::string version = {}, command_line = {};  ///< for the provenance
};

/// What sparse PGD learnt a field from, and what it says of the rest.
struct LearningReport {
  int trained_on = 0;  ///< snapshots
  /// The coordinates that say where a press is, e.g. "x and y"; empty: sites are choices.
  std::string place = {};
  SnapshotErrors unseen = {};
};

/// How one field was reduced, and how much of it was lost.
struct ReductionReport {
  std::string method = std::string(method_name(ReductionMethod::kPerSite));
  int modes = 0;                ///< with kPerSite the most of one site
  int columns = 0;              ///< modes that the body file holds, of all blocks
  double bytes = 0;             ///< of those, boundary only, single precision
  Eigen::VectorXd errors = {};  ///< after 1, 2, ... modes (see Reduction); of sparse PGD none
  std::vector<int> ranks = {};  ///< kHosvd
  std::optional<double> bound = {};
  bool reached = true;  ///< the tolerance was met
  double pooled = 0;    ///< of the result, over the volume
  double median = 0;    ///< error of the middle snapshot in its own norm, over the volume
  double worst = 0;     ///< of the worst one
  /// Largest difference of the body as the live half evaluates it (single precision, boundary) from
  /// the snapshots there, relative to the largest value of all. Contains the reduction error.
  double evaluated_worst = 0;
  std::optional<LearningReport> learning = {};  ///< sparse PGD only
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

/// Reduces the snapshots of a complete store to a body, boundary only unless settings.volume. Reads
/// them in blocks: memory is 200 MB, 24 bytes for each pair of snapshots and what the modes take;
/// with sparse PGD the snapshots that it learns from, twice, in double precision.
/// What a touch between sites costs is stated where the store has linear responses.
/// @throws Error if a unit is missing or damaged, `at` names what the store does not have, or a
///         method cannot be had of this store
[[nodiscard]] BakedBody reduce_store(const SnapshotStore& store, const ReduceSettings& settings,
                                     const Progress& progress = {});

/// Solves the campaign of a description into a temporary store and reduces that. Deterministic,
/// whatever the number of threads.
[[nodiscard]] BakedBody bake_body(const BodyDescription& description, const BakeSettings& settings,
                                  const Progress& progress = {});

}  // namespace palpable
