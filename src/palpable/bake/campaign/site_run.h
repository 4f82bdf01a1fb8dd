/// @file
/// Solves the sites of a campaign, many at a time: the load, the equilibrium path and the stress of
/// each.
///
///   N  nodes     L  solved levels (level 0, at rest, is not among them)
#pragma once

#include "palpable/bake/campaign/press_solver.h"
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/common/base/stage_clock.h"
#include "palpable/common/geometry/tet_mesh.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// Revision of solve_sites(). Increase it with every change that alters results for the same input:
/// it enters the keys of stored snapshots, so that those of another revision are solved again.
inline constexpr int kSiteRunRevision = 5;

struct SiteRunSettings {
  double press = 0;  ///< m: displacement of a site's patch along its load at level 1
  double force = 0;  ///< N: the load at level 1, if above 0; then `press` is not read
  int levels = 10;   ///< L: equal steps of the load, 1/L .. 1
  double range = 0;  ///< m: how far a press may move a node; 0: as far as the model says
  /// (L) If given, used instead of `levels`: increasing levels of known loads (held-out levels).
  std::vector<double> at = {};
  /// (S) N: the load of each site at level 1; with `at` only.
  std::vector<double> full_loads = {};
};

/// The outcome of the path of one site.
struct SiteOutcome {
  bool reached_press = true;  ///< or the requested force
  double press = 0;           ///< m, reached at level 1
  std::string shortfall;      ///< why not, in one line; empty when the press was reached
  int newton_steps = 0;
  int cg_iterations = 0;
  double smallest_volume_ratio = 1;  ///< min det F over elements and levels
};

/// The snapshots of one site. In single precision, because campaigns are large: its rounding error,
/// 6e-8, is far below the errors of the solver and of the reduction.
struct SiteSnapshots {
  double full_load = 0;          ///< N
  Eigen::MatrixXf displacement;  ///< (3N x L) m, relative to the body at rest
  Eigen::MatrixXf stress;        ///< (6N x L) Pa, Cauchy, xx yy zz xy yz zx per node; likewise
  Eigen::VectorXd press_depth;   ///< (L + 1) m, 0 first, increasing
  double largest_von_mises = 0;  ///< Pa, over levels and boundary nodes
  SiteOutcome outcome;
};

/// The body at rest, and the data that all sites share.
class SiteSolver {
 public:
  /// @param solver, boundary  outlive this; boundary of solver.model().mesh
  /// @param preload, range    see PressSolver
  /// @throws Error when the body has no equilibrium under the preload
  SiteSolver(const EquilibriumSolver& solver, const Boundary& boundary,
             const Eigen::Matrix3Xd& preload, double range = 0);

  [[nodiscard]] const PressSolver& presses() const { return presses_; }
  [[nodiscard]] const Boundary& boundary() const { return boundary_; }
  /// (3 x N) m: the displacement of the preloaded body; zero without a preload.
  [[nodiscard]] const Eigen::Matrix3Xd& rest() const { return presses_.rest(); }
  /// Nodal Cauchy stress in the state u (displacement from the unloaded body) minus that at rest.
  [[nodiscard]] StressField added_stress(const Eigen::Matrix3Xd& u) const;

 private:
  PressSolver presses_;
  const Boundary& boundary_;
  StressRecovery recovery_;
  StressField rest_stress_;  // no columns: none
};

/// Callbacks of solve_sites(). `next` is called by one thread at a time, the others concurrently.
struct SiteStream {
  /// The number of the next site; nothing: there are no more.
  std::function<std::optional<int>()> next;
  /// Reports which part of a site's work is done, 0 .. 1.
  std::function<void(int site, double part)> tick;
  /// @param times  solve, stress: milliseconds, waiting for other lanes included
  std::function<void(int site, SiteSnapshots snapshots, const StageTimes& times)> finished;
};

/// Solves each site that the stream hands out: finds the load that displaces its patch by the press
/// (or takes the given force), then computes the path to that load and the stress at each level. A
/// load is distributed over the patch by its weights and acts along the site's direction, which
/// stays fixed (dead load).
///
/// Where the body collapses, buckles or inverts an element before the press is reached, the site is
/// solved up to the load that was reached, and its outcome says so. Its load is lowered until the
/// press depth grows strictly with every level, because the live half inverts that table.
///
/// The snapshots of a site depend on `solver`, the site and the settings alone, to the last bit:
/// not on the number of threads, nor on the sites that are solved at the same time.
/// @param sites    all of the campaign
/// @param threads  number of threads
/// @throws Error naming the site, if one cannot be pressed at all; what the stream throws
void solve_sites(const SiteSolver& solver, std::span<const Site> sites,
                 const SiteRunSettings& settings, int threads, const SiteStream& stream);

/// Callbacks of solve_linear(); as SiteStream.
struct LinearStream {
  std::function<std::optional<int>()> next;  ///< the first site of the next row
  /// @param u  (3V x count) m/N on the skin: displacement per force on each of the row's patches
  std::function<void(int first, Eigen::MatrixXf u)> finished;
};

/// The linear response of the body at rest to loads on sites first .. first + count - 1 (fewer at
/// the end). As solve_sites() otherwise.
void solve_linear(const SiteSolver& solver, std::span<const Site> sites, int count, int threads,
                  const LinearStream& stream);

}  // namespace palpable
