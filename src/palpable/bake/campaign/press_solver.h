/// @file
/// Presses on a body that something else acts on already: its weight, pressures, supports that
/// move.
///
///   N  nodes      u  displacement from the unloaded body, (3 x N) m
#pragma once

#include "palpable/bake/solid/equilibrium.h"

#include <Eigen/Core>

#include <functional>
#include <span>

namespace palpable {

/// EquilibriumSettings::tolerance for snapshots. Against 1e-9, on eight sites of the bunny with six
/// levels, ears among them, it changed displacements by at most 1.4e-6 of their norm and stresses
/// by 3.7e-6 (steps overshoot it); a reduction gives up more. 1e-6 takes a sixth more iterations.
inline constexpr double kSnapshotTolerance = 1e-5;

/// Equilibria under  preload + level * press,  supports moved all the way at every level.
///
/// The preload comes first and in full; presses and their levels are counted from the shape that it
/// gives the body, and paths start there: they cost what paths of the unloaded body do. Without
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
  [[nodiscard]] bool is_preloaded() const { return is_preloaded_; }
  /// What acts before anything presses; nullptr without.
  [[nodiscard]] const Preloaded* preloaded() const { return is_preloaded_ ? &preloaded_ : nullptr; }
  /// (3 x N) u under the preload alone; zero without one.
  [[nodiscard]] const Eigen::Matrix3Xd& rest() const { return preloaded_.rest; }

  /// As EquilibriumSolver's; displacements are from the unloaded body, presses from rest().
  /// @param lane  shares passes through the factor; nullptr: alone
  /// @param tick  see PathOptions
  [[nodiscard]] PathResult solve_path(const Eigen::Matrix3Xd& full_load,
                                      std::span<const double> levels, Lane* lane = nullptr) const;
  [[nodiscard]] LoadSearch find_load(const Eigen::Matrix3Xd& unit_load, double wanted_press,
                                     Lane* lane = nullptr) const;
  [[nodiscard]] Eigen::Matrix3Xd linear_response(const Eigen::Matrix3Xd& load,
                                                 Lane* lane = nullptr) const;
  [[nodiscard]] PressPath press_path(const Eigen::Matrix3Xd& unit_load, const PressGoal& goal,
                                     Lane* lane = nullptr,
                                     std::function<void(double part)> tick = {}) const;

 private:
  [[nodiscard]] PathOptions options(Lane* lane) const {
    return {.preloaded = is_preloaded_ ? &preloaded_ : nullptr, .lane = lane, .tick = {}};
  }

  const EquilibriumSolver& solver_;
  bool is_preloaded_ = false;
  Preloaded preloaded_;
};

}  // namespace palpable
