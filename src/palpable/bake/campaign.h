/// @file
/// All sites at all load levels: the snapshots from which a body is reduced (paper Sec. 5.2).
///
///   N  nodes     S  sites     L  solved levels (level 0, at rest, is not among them)
#pragma once

#include "palpable/bake/greedy_pgd.h"
#include "palpable/bake/site_run.h"
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
  double force = 0;  ///< N: the load at level 1, if above 0; then `press` is not read
  int levels = 10;   ///< L: equal steps of the load, 1/L .. 1
  /// (3 x N) N: what acts on the body all the while; no columns: nothing. Supports that move have
  /// moved all the way before the first press.
  Eigen::Matrix3Xd preload = Eigen::Matrix3Xd(3, 0);
  int threads =
      0;  ///< batches solved side by side; 0: one per core. The result does not depend on it
};

struct Campaign {
  std::vector<Site> sites;  ///< (S) with full_load found
  Eigen::VectorXd levels;   ///< (L + 1) 0, 1/L .. 1
  /// (3 x N) m: the displacement of the preloaded body, from which presses are counted; zero
  /// without a preload.
  Eigen::Matrix3Xd rest;
  /// (3N x S L) m; parameters site, level (1/L .. 1). What the press adds to `rest`.
  SnapshotTensor displacement;
  /// (6N x S L) Pa, Cauchy, xx yy zz xy yz zx per node. What the press adds to the stress at rest.
  SnapshotTensor stress;
  Eigen::MatrixXd press_depth;        ///< (L + 1 x S) m, 0 in the first row, increasing downwards
  std::vector<SiteOutcome> outcomes;  ///< (S)
  double largest_von_mises = 0;       ///< Pa, over all snapshots and boundary nodes
  StageTimes times;  ///< load search, solve, stress: milliseconds, summed over all threads
};

/// Solves all sites, batch by batch (site_run.h), on some threads.
/// @param boundary  of solver.model().mesh; sites refer to its vertices
/// @throws Error if no site reaches the press, one site cannot be pressed at all, or the body
///         cannot bear the preload
[[nodiscard]] Campaign run_campaign(const EquilibriumSolver& solver, const Boundary& boundary,
                                    std::vector<Site> sites, const CampaignSettings& settings,
                                    const Progress& progress = {});

}  // namespace palpable
