/// @file
/// Solves presses on a body under a preload: its weight, pressures, supports that move.
///
///   N  nodes      u  displacement from the unloaded body, (3 x N) m
#pragma once

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/common/base/error.h"

#include <Eigen/Core>

#include <functional>
#include <span>

namespace palpable {

/// EquilibriumSettings::tolerance for snapshots. Compared with 1e-9, on eight sites of the bunny
/// (ears among them) with six levels, displacements change by at most 1.4e-6 of their norm and
/// stresses by 3.7e-6: less than 1e-5, because the last Newton step overshoots the tolerance. The
/// error of a reduction is larger. 1e-6 would take a sixth more iterations.
inline constexpr double kSnapshotTolerance = 1e-5;

/// Thrown where a body has no equilibrium under its preload. Those that know the description add
/// what acts on it (preload_words()).
struct PreloadError : Error {
  using Error::Error;
};

/// Equilibria under  preload + level * press,  supports moved all the way at every level.
///
/// The full preload is applied first. Presses and their levels are measured from the preloaded
/// state, and paths start there, so they take as long as paths of the unloaded body. Without a
/// preload, all calls are passed to EquilibriumSolver unchanged.
///
/// Const members may be called from several threads.
class PressSolver {
 public:
  /// @param solver   outlives this
  /// @param preload  (3 x N) N, or no columns for none
  /// @param range    m: how far a press may move a node; 0: as far as the model says
  /// @throws PreloadError when the body has no equilibrium under the preload
  PressSolver(const EquilibriumSolver& solver, const Eigen::Matrix3Xd& preload, double range = 0);

  [[nodiscard]] const EquilibriumSolver& solver() const { return solver_; }
  [[nodiscard]] bool is_preloaded() const { return is_preloaded_; }
  /// m: how far a press may move a node.
  [[nodiscard]] double range() const {
    return range_ > 0.0 ? range_ : solver_.model().largest_displacement;
  }
  /// The preload and its equilibrium; nullptr without a preload.
  [[nodiscard]] const Preloaded* preloaded() const { return is_preloaded_ ? &preloaded_ : nullptr; }
  /// (3 x N) u under the preload alone; zero without one.
  [[nodiscard]] const Eigen::Matrix3Xd& rest() const { return preloaded_.rest; }

  /// As the functions of EquilibriumSolver. Displacements are measured from the unloaded body,
  /// presses from rest().
  /// @param lane  shares passes through the factor with other solves; nullptr: solves alone
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
    return {.preloaded = is_preloaded_ ? &preloaded_ : nullptr,
            .range = range_,
            .lane = lane,
            .tick = {}};
  }

  const EquilibriumSolver& solver_;
  double range_;
  bool is_preloaded_ = false;
  Preloaded preloaded_;
};

}  // namespace palpable
