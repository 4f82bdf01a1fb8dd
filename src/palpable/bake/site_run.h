/// @file
/// The work of a campaign, one batch of sites at a time: loads, paths, stresses.
///
///   N  nodes     L  solved levels (level 0, at rest, is not among them)
#pragma once

#include "palpable/bake/press_solver.h"
#include "palpable/base/stage_clock.h"
#include "palpable/geometry/tet_mesh.h"
#include "palpable/reduced/reduced_body.h"
#include "palpable/solid/equilibrium.h"
#include "palpable/solid/stress.h"

#include <Eigen/Core>

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// To be raised by whoever changes what solve_sites() answers for the same question: snapshots that
/// are stored carry it, and those of another revision are solved again.
inline constexpr int kSiteRunRevision = 1;

struct SiteRunSettings {
  double press = 0;  ///< m: how far the patch of a site shall give way along its load at level 1
  double force = 0;  ///< N: the load at level 1, if above 0; then `press` is not read
  int levels = 10;   ///< L: equal steps of the load, 1/L .. 1
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

/// The body before anybody presses it, and what every batch shares.
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

/// The batches of a campaign of `site_count` sites: first site of each, and one past the last site.
/// A function of the count alone, so that results depend neither on threads nor on processes.
[[nodiscard]] std::vector<int> site_batches(int site_count);

/// For each site of a batch: the load at which its patch gives way by the press (or the force that
/// is given), then the path to that load and the stress at each level. Loads act on the patch in
/// proportion to its weights, along the site's direction, and keep it (dead loads).
///
/// A site whose body yields, buckles or turns an element inside out before the press is solved up
/// to what it reaches, and its outcome says so. Its load is lowered until the press depth grows
/// strictly with every level, because the live half inverts that table.
///
/// A function of its arguments, to the last bit. May run in several threads on one `solver`.
/// @param first  number of the first site, for messages
/// @param times  adds load search, solve, stress: milliseconds
/// @param tick   called from this thread with the done part of the batch, 0 .. 1; may be empty
/// @throws Error naming the site, if one cannot be pressed at all
[[nodiscard]] std::vector<SiteSnapshots> solve_sites(const SiteSolver& solver,
                                                     std::span<const Site> sites, int first,
                                                     const SiteRunSettings& settings,
                                                     StageTimes& times,
                                                     const std::function<void(double)>& tick = {});

}  // namespace palpable
