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

/// Settings of reduce_store().
struct ReduceSettings {
  std::optional<ReductionMethod> method = {};  ///< none: as the body's description says
  /// None: as the description says; default_tolerance() for a method other than the description's.
  std::optional<double> tolerance = {};
  std::optional<int> max_modes = {};   ///< none: as the description says
  std::optional<bool> own_norms = {};  ///< ReductionSettings::weight_snapshots; likewise
  /// If given, sparse PGD, which learns from a part of the snapshots, is used instead of `method`;
  /// cannot be combined with method, tolerance or own_norms.
  std::optional<SparseCampaignSettings> sparse = {};
  /// Values of parameters beyond site and level. Empty: the parameters stay free, and the body
  /// holds all their values (ReducedBody::further). Otherwise the body holds one value of each: the
  /// given one, or the middle of its list for a parameter that is not named.
  std::map<std::string, double> at = {};
  bool volume = false;                          ///< also keep all nodes: ReducedBody::volume
  std::string version = {}, command_line = {};  ///< for the provenance
};

/// The snapshots from which sparse PGD learnt a field, and its errors on the others.
struct LearningReport {
  int trained_on = 0;  ///< snapshots
  /// The coordinates that are the parameters of a press's position, e.g. "x and y"; empty: the
  /// sites are discrete choices.
  std::string place = {};
  SnapshotErrors unseen = {};
};

/// How one field was reduced, and the errors of that.
struct ReductionReport {
  std::string method = std::string(method_name(ReductionMethod::kPerSite));
  int modes = 0;                ///< with kPerSite the largest number of a site
  int columns = 0;              ///< modes that the body file holds, of all blocks
  double bytes = 0;             ///< of those, boundary only, single precision
  Eigen::VectorXd errors = {};  ///< after 1, 2, ... modes (see Reduction); empty for sparse PGD
  std::vector<int> ranks = {};  ///< kHosvd
  std::optional<double> bound = {};
  bool reached = true;  ///< the tolerance was met
  double pooled = 0;    ///< of the result, over the volume
  double median = 0;    ///< error of the middle snapshot in its own norm, over the volume
  double worst = 0;     ///< of the worst one
  /// Largest difference between the body as the live half evaluates it (single precision, boundary)
  /// and the snapshots there, relative to the largest value of all snapshots. Includes the error of
  /// the reduction.
  double evaluated_worst = 0;
  std::optional<LearningReport> learning = {};  ///< sparse PGD only
};

struct BakeReport {
  int nodes = 0, tets = 0, vertices = 0, triangles = 0;
  std::vector<SiteOutcome> outcomes;
  ReductionReport displacement, stress;
  std::string held_out = {};       ///< of held_out_checks.h; empty: not checked
  std::string between_sites = {};  ///< one line; empty: the store has no linear responses
  StageTimes wall;                 ///< wall time, ms: mesh, campaign, reduce
  StageTimes threads;              ///< ms of the campaign's parts, summed over threads
};

struct BakedBody {
  ReducedBody body;
  BakeReport report;
};

/// Reduces the snapshots of a complete store to a body, boundary only unless settings.volume. Reads
/// them in blocks. Memory: 200 MB, 24 bytes for each pair of snapshots, and the modes; with sparse
/// PGD also the snapshots that it learns from, twice, in double precision. States the error of
/// touches between sites where the store has linear responses.
/// @throws Error if a unit is missing or damaged, `at` names what the store does not have, or the
///         method cannot be applied to this store
[[nodiscard]] BakedBody reduce_store(const SnapshotStore& store, const ReduceSettings& settings,
                                     const Progress& progress = {});

/// Solves the campaign of a description into a temporary store and reduces that. Deterministic,
/// whatever the number of threads.
[[nodiscard]] BakedBody bake_body(const BodyDescription& description, const BakeSettings& settings,
                                  const Progress& progress = {});

}  // namespace palpable
