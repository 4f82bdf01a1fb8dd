/// @file
/// Solves all sites at all load levels and all parameter values into a store (paper Sec. 5.2).
///
///   N  nodes     S  sites     L  solved levels     P  points (snapshot_store.h)
#pragma once

#include "palpable/bake/campaign/crew.h"
#include "palpable/bake/campaign/site_run.h"
#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/solid_model.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/base/stage_clock.h"

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// What a body is made of at one point of the parameters.
struct PointMaterials {
  Material material;
  std::vector<Material> groups;  ///< one for each of model.groups
};

/// Who solves for the equilibrium of a press.
enum class FeSolver {
  kOwn,      ///< press_solver.h
  kCalculix  ///< calculix_sites.h
};

/// "own" or "calculix": the name that a user types; it also enters the keys of units.
[[nodiscard]] std::string_view fe_solver_name(FeSolver solver);

/// What is to be solved.
struct CampaignPlan {
  SolidModel model;         ///< at the first point
  Boundary boundary;        ///< of model.mesh; sites refer to its vertices
  std::vector<Site> sites;  ///< (S) full loads not known yet
  /// Sites whose linear responses are stored as well; may be empty. Only with one point.
  std::vector<Site> linear;
  SiteRunSettings run;
  /// (3 x N) N: forces that act at every level; no columns: none. Supports that move have reached
  /// their final displacement before the first press.
  Eigen::Matrix3Xd preload = Eigen::Matrix3Xd(3, 0);
  std::vector<PointMaterials> points;  ///< (P) at least one
  FeSolver solver = FeSolver::kOwn;
  /// (P S) N: load of each unit at level 1, if run.at is given; run.full_loads is not read.
  std::vector<double> full_loads = {};
};

/// (P S) The key of each unit: a hash of everything it is computed from, i.e. file layout, revision
/// of the solver, mesh, materials, supports, loads, levels, and its site.
[[nodiscard]] std::vector<std::uint64_t> unit_keys(const CampaignPlan& plan);

/// The same for the linear responses.
[[nodiscard]] std::uint64_t linear_key(const CampaignPlan& plan);

struct CampaignSettings {
  int threads = 0;  ///< 0: one per core. Results do not depend on it
  /// Only every `shards`-th unit from number `shard` on is solved here.
  int shard = 0;
  int shards = 1;
  std::string calculix = "ccx";  ///< the program, for FeSolver::kCalculix
};

struct CampaignReport {
  int reused = 0;  ///< units that the store held already
  int solved = 0;
  int missing = 0;        ///< units and files of other shards
  int linear_solved = 0;  ///< files of linear responses that were solved
  StageTimes times;       ///< solve, stress, write: milliseconds, summed over sites
  SolverSetup setup;      ///< of the last point that was solved
};

/// Solves the units (a site at a point of the parameters) that the snapshot store does not hold
/// yet. A site's file is written as soon as it is solved, so an aborted run loses only the sites in
/// progress. The bytes of the store depend on the plan alone.
///
/// Memory: that of the solver; for each site in progress that of a call of the solver
/// (equilibrium.h) and 24 N L bytes, with at most 20 such sites per thread and about as many as fit
/// into 2 GB (lockstep.h); and, for each site that is being written, another 60 N L bytes. N:
/// nodes, L: load levels.
/// @param store  of unit_keys(plan)
/// @throws Error if no site of a point reaches the press depth or the force of its description, one
/// site cannot be pressed at all, the body has no equilibrium under the preload, or the store
/// cannot be written
[[nodiscard]] CampaignReport run_campaign(const CampaignPlan& plan, const SnapshotStore& store,
                                          Crew& crew, const CampaignSettings& settings,
                                          const Progress& progress = {});

}  // namespace palpable
