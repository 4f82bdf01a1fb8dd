/// @file
/// Follows one equilibrium path: the present state, and everything that a step needs.
/// Internal to this module; equilibrium.h is what others use.
#pragma once

#include "palpable/bake/solid/conjugate_gradients.h"
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/quasi_newton.h"
#include "palpable/bake/solid/solver_core.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// Newton's method from level to level, in either direction:
///
///     internal_force(u) = preload + level * load      at the free nodes
///
/// Each solve starts from an extrapolation of, or interpolation between, the states known so far.
class Walk {
 public:
  /// Why a solve ended, with the figures of the state at which it ended.
  struct Failure {
    Stop stop = Stop::kNone;
    int element = -1;         ///< kInversion
    double volume_ratio = 0;  ///< kInversion
    double residual = 0;      ///< kNoConvergence, kLinearSolver
    explicit operator bool() const { return stop != Stop::kNone; }
  };

  /// Begins at level 0 with the undeformed body, or with the preloaded one. All arguments must
  /// outlive the walk.
  /// @param load  (3 x N) N, at level 1
  Walk(const EquilibriumSolver::Core& core, const Eigen::Matrix3Xd& load,
       const PathOptions& options);

  [[nodiscard]] const Equilibrium& now() const { return now_; }
  [[nodiscard]] const Failure& failure() const { return failure_; }
  [[nodiscard]] int factors() const { return factors_; }
  [[nodiscard]] int halvings() const { return halvings_; }
  [[nodiscard]] const SolveTimes& times() const { return times_; }
  /// load . (u - u at level 0), N m, with the load at level 1. For a load of 1 N it is the press,
  /// m.
  [[nodiscard]] double work_conjugate() const;

  /// Solves up (or down) to level `target`, halving increments that fail. False: now() is the last
  /// state that was reached, and failure() says why there is no further one.
  /// @param tolerance  as EquilibriumSettings::tolerance
  bool advance(double target, double tolerance);

  /// Goes back to level 0. The states found so far are kept; later solves start from interpolations
  /// between them.
  void return_to_start();

  /// du = du/dlevel at now(), (3 x N) m, with supports at rest. False if the tangent is not
  /// positive definite or conjugate gradients do not converge.
  /// @param tolerance  of the residual, relative to the load
  bool linear_response(double tolerance, Eigen::Matrix3Xd& du);

  /// failure() in words, one line; empty without one.
  [[nodiscard]] std::string describe_failure() const;

 private:
  struct Knot {
    double level;
    Eigen::Matrix3Xd u;
  };

  [[nodiscard]] std::string describe_collapse() const;
  void set_supports(double level, Eigen::Matrix3Xd& u) const;
  BodyState force_at(const Eigen::Matrix3Xd& u);
  BodyState evaluate(double level, const Eigen::Matrix3Xd& u);
  void update_residual(double level);
  [[nodiscard]] double load_potential(double level, const Eigen::Matrix3Xd& u) const;
  [[nodiscard]] Eigen::Matrix3Xd through(const std::vector<const Knot*>& knots, double level,
                                         int order) const;
  std::optional<Eigen::Matrix3Xd> dragged(double level);
  Eigen::Matrix3Xd predict(double level);
  bool renew_factor(const Eigen::Matrix3Xd& u);
  CgResult solve_tangent(const Eigen::Matrix3Xd& u, double relative_tolerance);
  Failure newton_step(const Eigen::Matrix3Xd& u, double tolerance);
  Failure solve(double level, double tolerance);
  void move_to(double level, Eigen::Matrix3Xd u, const BodyState& state, double residual);

  const EquilibriumSolver::Core& core_;
  const TetAssembly& assembly_;
  const EquilibriumSettings& settings_;
  const Eigen::Matrix3Xd& load_;
  const Preloaded* preloaded_;  // nullptr: no other forces than the load
  Lane* lane_;                  // nullptr: alone
  double range_;                // m, see PathOptions
  bool supports_grow_;          // some supports move in proportion to the level

  FactorWorkspace workspace_;
  std::optional<BlockMatrix> K_;  // the tangent; made when the factor is first renewed
  const CholeskyFactor* factor_;
  std::optional<CholeskyFactor> own_factor_;
  bool factor_is_slow_ = false;
  QuasiNewton corrections_;  // of factor_
  CgScratch cg_scratch_;
  Eigen::VectorXd free_load_, free_preload_;  // in the free directions, at level 1
  Eigen::VectorXd r_, d_;
  Eigen::Matrix3Xd force_;
  PassFields fields_;
  double scale_ = 0.0;  // what the residual is relative to, N

  // States found: those since the last start from level 0, including it, and those before that.
  std::vector<Knot> knots_, guides_;
  Equilibrium start_, now_;
  Failure failure_;
  SolveTimes times_;
  std::vector<NewtonStep> convergence_;  // since advance() was called
  int cg_iterations_ = 0;                // since advance() was called
  int all_iterations_ = 0, factors_ = 0, halvings_ = 0;
};

}  // namespace palpable
