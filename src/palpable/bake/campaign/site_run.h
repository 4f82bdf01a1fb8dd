/// @file
/// The work of a campaign: loads, paths, stresses of sites, many at a time.
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

/// To be raised by whoever changes what solve_sites() answers for the same question: snapshots that
/// are stored carry it, and those of another revision are solved again.
inline constexpr int kSiteRunRevision = 5;

struct SiteRunSettings {
  double press = 0;  ///< m: how far the patch of a site shall give way along its load at level 1
  double force = 0;  ///< N: the load at level 1, if above 0; then `press` is not read
  int levels = 10;   ///< L: equal steps of the load, 1/L .. 1
  /// (L) instead: these levels, increasing, of loads that are known (held-out levels).
  std::vector<double> at = {};
  /// (S) N: the load of each site at level 1; with `at` only.
  std::vector<double> full_loads = {};
};

/// How the path of one site went.
struct SiteOutcome {
  bool reached_press = true;  ///< or bears the force that was asked for
  double press = 0;           ///< m, at level 1
  std::string shortfall;      ///< one line; empty when the press was reached
  int newton_steps = 0;
  int cg_iterations = 0;
  double smallest_volume_ratio = 1;  ///< min det F over elements and levels
};

/// What one site adds to a campaign. Single precision: its rounding, 6e-8, is far below what a
/// solve leaves and a reduction gives up, and campaigns are large.
struct SiteSnapshots {
  double full_load = 0;          ///< N
  Eigen::MatrixXf displacement;  ///< (3N x L) m, what the press adds to the body at rest
  Eigen::MatrixXf stress;        ///< (6N x L) Pa, Cauchy, xx yy zz xy yz zx per node; likewise
  Eigen::VectorXd press_depth;   ///< (L + 1) m, 0 first, increasing
  double largest_von_mises = 0;  ///< Pa, over levels and boundary nodes
  SiteOutcome outcome;
};

/// The body before anybody presses it, and what all sites share.
class SiteSolver {
 public:
  /// @param solver, boundary  outlive this; boundary of solver.model().mesh
  /// @param preload           (3 x N) N, or no columns: see PressSolver
  /// @throws Error when the body cannot bear the preload
  SiteSolver(const EquilibriumSolver& solver, const Boundary& boundary,
             const Eigen::Matrix3Xd& preload);

  [[nodiscard]] const PressSolver& presses() const { return presses_; }
  [[nodiscard]] const Boundary& boundary() const { return boundary_; }
  /// (3 x N) m: the displacement of the preloaded body; zero without a preload.
  [[nodiscard]] const Eigen::Matrix3Xd& rest() const { return presses_.rest(); }
  /// Nodal Cauchy stress that the press adds in the state u (from the unloaded body).
  [[nodiscard]] StressField added_stress(const Eigen::Matrix3Xd& u) const;

 private:
  PressSolver presses_;
  const Boundary& boundary_;
  StressRecovery recovery_;
  StressField rest_stress_;  // no columns: none
};

/// How sites come and go while they are solved. `next` is called by one thread at a time, the
/// others by several at once.
struct SiteStream {
  /// The number of the next site; none: that was all.
  std::function<std::optional<int>()> next;
  /// The part of a site that is done, 0 .. 1.
  std::function<void(int site, double part)> tick;
  /// @param times  solve, stress: milliseconds, waiting for other lanes included
  std::function<void(int site, SiteSnapshots snapshots, const StageTimes& times)> finished;
};

/// For each site that the stream hands out: the load at which its patch gives way by the press (or
/// the force that is given), then the path to that load and the stress at each level. Loads act on
/// the patch in proportion to its weights, along the site's direction, and keep it (dead loads).
///
/// A site whose body yields, buckles or turns an element inside out before the press is solved up
/// to what it reaches, and its outcome says so. Its load is lowered until the press depth grows
/// strictly with every level, because the live half inverts that table.
///
/// What a site's snapshots are depends on nothing but `solver`, the site and the settings, to the
/// last bit: not on threads, nor on which other sites are solved beside it.
/// @param sites    all of the campaign
/// @param threads  that run at a time
/// @throws Error naming the site, if one cannot be pressed at all; what the stream throws
void solve_sites(const SiteSolver& solver, std::span<const Site> sites,
                 const SiteRunSettings& settings, int threads, const SiteStream& stream);

/// How linear responses come and go; as SiteStream.
struct LinearStream {
  std::function<std::optional<int>()> next;  ///< the first of a row of sites
  /// @param u  (3V x count) m/N on the skin: displacement per force on each of the row's patches
  std::function<void(int first, Eigen::MatrixXf u)> finished;
};

/// The linear response of the body at rest to loads on sites first .. first + count - 1 (fewer at
/// the end). As solve_sites() otherwise.
void solve_linear(const SiteSolver& solver, std::span<const Site> sites, int count, int threads,
                  const LinearStream& stream);

}  // namespace palpable
