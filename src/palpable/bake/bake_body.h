/// @file
/// The whole bake: description -> mesh -> campaign -> reduction -> body.
#pragma once

#include "palpable/bake/body_description.h"
#include "palpable/bake/body_mesh.h"
#include "palpable/bake/campaign.h"
#include "palpable/bake/greedy_pgd.h"
#include "palpable/base/progress.h"
#include "palpable/base/stage_clock.h"
#include "palpable/reduced/reduced_body.h"

#include <string>

namespace palpable {

struct BakeSettings {
  int threads = 0;           ///< 0: one per core
  std::string version;       ///< of the program, for the provenance
  std::string command_line;  ///< likewise
};

/// How one field was reduced, and how much of it was lost.
struct ReductionReport {
  Eigen::VectorXd errors;  ///< relative pooled L2 after 1, 2, ... modes (see GreedyResult)
  bool reached = true;     ///< the tolerance was met
  double pooled = 0;       ///< of the result, over the volume
  double worst = 0;        ///< largest error of one snapshot in its own norm, over the volume
  /// Largest difference of the body as the live half evaluates it (single precision, boundary) from
  /// the snapshots there, relative to the largest value of all. Contains the reduction error.
  double evaluated_worst = 0;
};

struct BakeReport {
  int nodes = 0, tets = 0, vertices = 0, triangles = 0;
  std::vector<SiteOutcome> outcomes;
  ReductionReport displacement, stress;
  StageTimes wall;     ///< ms by the clock on the wall: mesh, factor, campaign, reduce
  StageTimes threads;  ///< ms of the campaign's parts, summed over threads
};

struct BakedBody {
  ReducedBody body;
  BakeReport report;
};

/// Bakes a body. Deterministic, whatever the number of threads.
/// @throws Error for everything in the world that is not as hoped: mesh, supports, loads
[[nodiscard]] BakedBody bake_body(const BodyDescription& description, const BakeSettings& settings,
                                  const Progress& progress = {});

/// The last step of it: snapshots of a campaign on `mesh` to a body, boundary only.
[[nodiscard]] BakedBody reduce_campaign(const Campaign& campaign, const BodyMesh& mesh,
                                        const BodyDescription::Reduction& settings,
                                        const Progress& progress = {});

}  // namespace palpable
