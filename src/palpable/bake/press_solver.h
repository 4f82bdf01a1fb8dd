/// @file
/// Presses on a body that something else acts on already: its weight, pressures, supports that
/// move.
///
///   N  nodes      u  displacement from the unloaded body, (3 x N) m
#pragma once

#include "palpable/solid/equilibrium.h"

#include <Eigen/Core>

#include <memory>
#include <span>

namespace palpable {

/// Equilibria under  preload + level * press,  supports moved all the way at every level.
///
/// The preload comes first and in full; presses and their levels are counted from the shape that it
/// gives the body. All loads are dead and the body is elastic, so a state does not depend on the
/// way to it, as long as nothing buckles; each is reached from the unloaded body with all loads
/// growing together, since EquilibriumSolver has no part of a load that stays. That takes
/// several times as long as a plain path, on which each level starts from those before it. Without
/// a preload, everything is handed to EquilibriumSolver as it is.
///
/// Const members may be called from several threads.
class PressSolver {
 public:
  /// @param solver   outlives this
  /// @param preload  (3 x N) N, or no columns for none
  /// @throws Error when the body cannot bear the preload
  PressSolver(const EquilibriumSolver& solver, const Eigen::Matrix3Xd& preload);

  [[nodiscard]] const EquilibriumSolver& solver() const { return solver_; }
  [[nodiscard]] bool is_preloaded() const { return preload_.cols() > 0; }
  /// (3 x N) u under the preload alone; zero without one.
  [[nodiscard]] const Eigen::Matrix3Xd& rest() const { return rest_; }

  /// As EquilibriumSolver::solve_path(); displacements are from the unloaded body.
  [[nodiscard]] PathResult solve_path(const Eigen::Matrix3Xd& full_load,
                                      std::span<const double> levels) const;

  /// As EquilibriumSolver::find_load(), with the press sum(unit_load . (u - rest())).
  [[nodiscard]] LoadSearch find_load(const Eigen::Matrix3Xd& unit_load, double wanted_press) const;

 private:
  // One state; `complete` is false where it was not reached.
  [[nodiscard]] PathResult solve(const Eigen::Matrix3Xd& press) const;

  const EquilibriumSolver& solver_;
  // The same body with supports that stay where they are, to guess loads with; if they move.
  std::unique_ptr<const EquilibriumSolver> unmoved_;
  Eigen::Matrix3Xd preload_;  // no columns: none, and no support moves
  Eigen::Matrix3Xd rest_;
};

}  // namespace palpable
