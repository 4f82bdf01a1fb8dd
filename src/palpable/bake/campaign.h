/// @file
/// All sites at all load levels: the snapshots from which a body is reduced (paper Sec. 5.2).
///
///   N  nodes     S  sites     L  solved levels (level 0, at rest, is not among them)
#pragma once

#include "palpable/bake/greedy_pgd.h"
#include "palpable/base/progress.h"
#include "palpable/base/stage_clock.h"
#include "palpable/geometry/tet_mesh.h"
#include "palpable/reduced/reduced_body.h"
#include "palpable/solid/equilibrium.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace palpable {

struct CampaignSettings {
  double press = 0;  ///< m: how far the patch of a site shall give way along its load at level 1
  int levels = 10;   ///< L: equal steps of the load, 1/L .. 1
  int threads =
      0;  ///< sites solved side by side; 0: one per core. The result does not depend on it
};

/// How the path of one site went.
struct SiteOutcome {
  bool reached_press = true;
  double press = 0;       ///< m, at level 1
  std::string shortfall;  ///< one line; empty when the press was reached
  int newton_steps = 0;
  int cg_iterations = 0;
  double smallest_volume_ratio = 1;  ///< min det F over elements and levels
};

struct Campaign {
  std::vector<Site> sites;            ///< (S) with full_load found
  Eigen::VectorXd levels;             ///< (L + 1) 0, 1/L .. 1
  SnapshotTensor displacement;        ///< (3N x S L) m; parameters site, level (1/L .. 1)
  SnapshotTensor stress;              ///< (6N x S L) Pa, Cauchy, xx yy zz xy yz zx per node
  Eigen::MatrixXd press_depth;        ///< (L + 1 x S) m, 0 in the first row, increasing downwards
  std::vector<SiteOutcome> outcomes;  ///< (S)
  double largest_von_mises = 0;       ///< Pa, over all snapshots and boundary nodes
  StageTimes times;  ///< load search, solve, stress: milliseconds, summed over all threads
};

/// For each site: the load at which its patch gives way by the press (bisection-free search of the
/// solver), then the path to that load and the stress at each level. Loads act on the patch in
/// proportion to its weights, along the site's direction, and keep it (dead loads).
///
/// A site whose body yields, buckles or turns an element inside out before the press is baked up to
/// what it reaches, and its outcome says so. Its load is lowered until the press depth grows
/// strictly with every level, because the live half inverts that table.
///
/// @param boundary  of solver.model().mesh; sites refer to its vertices
/// @throws Error if no site reaches the press, or one site cannot be pressed at all
[[nodiscard]] Campaign run_campaign(const EquilibriumSolver& solver, const Boundary& boundary,
                                    std::vector<Site> sites, const CampaignSettings& settings,
                                    const Progress& progress = {});

}  // namespace palpable
