/// @file
/// Equilibrium of a hyperelastic body under a growing dead load (paper eqs. 1-3, weak form).
///
///   N  nodes      u  displacement, (3 x N) m     f  nodal forces, (3 x N) N
///   level  factor of the full load and of the fixed displacements, > 0
///
/// Total Lagrangian tetrahedra of 4 or 10 nodes: find u with u = level * fixed_displacement at the
/// held nodes and at all others
///
///     internal_force(u) = level * f,      internal_force = d/du sum_e V_e Psi(F_e)
///
/// Newton's method on that, from a start extrapolated over the levels before. Each step is solved
/// by conjugate gradients, whose products are passes over the elements and whose preconditioner is
/// the factor of the undeformed tangent, improved by what earlier solves learnt (quasi_newton.h).
/// That factor usually serves for a whole path and for all sites; it is renewed (per call, never
/// shared) where iterations grow all the same.
#pragma once

#include "palpable/solid/solid_model.h"

#include <Eigen/Core>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace palpable {

class Lane;

struct EquilibriumSettings {
  /// A state counts as solved when the residual at the free nodes is below this, relative to the
  /// norm of the applied forces, or of the forces at the held nodes if those are larger.
  double tolerance = 1e-8;
  int max_newton_steps = 30;  ///< per increment, before the increment is halved
  /// How often an increment may be halved in succession before the path stops.
  int max_halvings = 6;
  /// A step that takes more iterations than this renews the factor before the next one: a factor
  /// costs as much as some 60 iterations on a bunny of 16,000 nodes, and serves several steps.
  int refresh_iterations = 40;
  /// The same in lockstep, where a factor of one's own shares no pass with others: for the first of
  /// them, the others come as above.
  int refresh_iterations_in_lockstep = 150;
  /// A path in lockstep that has taken so many gets a factor of its own at once: it is beside
  /// collapse, would go on when the other lanes have ended, and pay whole passes alone. On the
  /// dragon six of 32 sites took more than half of all iterations, the hardest 4,489, the median
  /// 340.
  int iterations_in_lockstep = 600;
  int max_cg_iterations =
      400;  ///< per Newton step; then the factor is renewed and it is tried again
};

/// One step of Newton's method.
struct NewtonStep {
  double residual = 0;    ///< before it; relative, as EquilibriumSettings::tolerance
  int cg_iterations = 0;  ///< that found it
  double share = 1;       ///< of it that was taken: 1, 1/2, 1/4 ...
};

/// One state of the body.
struct Equilibrium {
  Eigen::Matrix3Xd displacement;  ///< (3 x N) m
  double level = 0;
  int newton_steps = 0;              ///< spent on the way from the level before
  int cg_iterations = 0;             ///< likewise
  double residual = 0;               ///< relative, as EquilibriumSettings::tolerance
  double smallest_volume_ratio = 1;  ///< min over elements of J = det F
  /// The steps from the level before, those of increments that failed among them.
  std::vector<NewtonStep> convergence = {};
};

/// What keeps a solve from going on.
enum class Stop {
  kNone,
  kInversion,          ///< every shortened step turns an element inside out
  kNegativeCurvature,  ///< the tangent is not positive definite: the body buckles or collapses
  kNoConvergence,      ///< Newton's method ran out of steps
  kLinearSolver        ///< conjugate gradients did, with a fresh factor, too
};

/// Where the CPU time of a path went, s.
struct SolveTimes {
  double factor_s = 0;        ///< factors that were renewed on the way
  double tangent_s = 0;       ///< tangents assembled for them
  double precondition_s = 0;  ///< solves with the factor, learning included
  double product_s = 0;       ///< tangent times vector
  double force_s = 0;         ///< forces, that is residuals
  double total_s = 0;         ///< of all, with what is none of these
};

/// What a solver's construction took, and how large its factor is.
struct SolverSetup {
  double pattern_s = 0;      ///< CPU: element blocks, neighbours
  double ordering_s = 0;     ///< order of elimination and structure of the factor
  double tangent_s = 0;      ///< tangent of the undeformed body
  double factor_s = 0;       ///< its factor
  double factor_flops = 0;   ///< of one factorisation
  double factor_bytes = 0;   ///< what one solve reads, twice
  double element_bytes = 0;  ///< what one pass over the elements reads
};

struct PathResult {
  std::vector<Equilibrium> steps;  ///< one per level reached, in order
  bool complete = false;           ///< all levels reached
  Stop stop = Stop::kNone;
  std::string why_stopped;  ///< empty when complete: one line, with the last good level
  int factors = 0;          ///< how often the factor was renewed on the way
  int halvings = 0;         ///< increments that had to be cut
  SolveTimes times;
};

/// A body that something acts on already, from the state that this leaves.
struct Preloaded {
  Eigen::Matrix3Xd force;  ///< (3 x N) N
  /// (3 x N) m: in equilibrium with `force`, supports moved all the way.
  Eigen::Matrix3Xd rest;
};

/// How a path is walked.
struct PathOptions {
  /// The path starts from there; that force acts on all the way, in full, and supports stay where
  /// they are. Levels and presses are counted from that state. nullptr: from the undeformed body.
  const Preloaded* preloaded = nullptr;
  /// Shares each pass through the factor with others (lockstep.h). nullptr: alone.
  Lane* lane = nullptr;
  /// Told after each state of a press_path(): the part of it that is done, 0 .. 1.
  std::function<void(double part)> tick = {};
};

struct LoadSearch {
  double load = 0;   ///< N; the last good one if not reached
  double press = 0;  ///< m, sum(unit_load . u) there
  bool reached = false;
  Stop stop = Stop::kNone;
  std::string why_stopped;  ///< empty when reached
  Equilibrium state;        ///< at `load`
  int solves = 0;           ///< equilibria computed
  int newton_steps = 0, cg_iterations = 0;
};

/// How far a body shall be pressed, and in how many steps.
struct PressGoal {
  double press = 0;  ///< m: sum(unit_load . u) at the full load, > 0
  double force = 0;  ///< N: the full load, if above 0; then `press` is not read
  int levels = 10;   ///< L >= 1: equal steps of the load
};

/// A path to the load that presses as far as asked for.
struct PressPath {
  double full_load = 0;            ///< N
  std::vector<Equilibrium> steps;  ///< (L) at level 1/L .. 1 of full_load
  Eigen::VectorXd press;           ///< (L + 1) m: 0 and sum(unit_load . u) of each, increasing
  bool reached = false;            ///< the press, or the force
  Stop stop = Stop::kNone;
  std::string why_stopped;                  ///< empty when reached
  int newton_steps = 0, cg_iterations = 0;  ///< of the search, too
  int factors = 0;                          ///< how often the factor was renewed
  int halvings = 0;                         ///< increments that had to be cut
  SolveTimes times;
};

/// The solver of one model: pattern, shape gradients and the factor of the undeformed tangent are
/// made once; every call has its own workspace. All const members may be called from several
/// threads at once on one object (sites side by side); a call itself uses one thread.
///
/// Memory: the factor, 4 kB a node on a bunny of 16,000 nodes (8 in 32 bits; 8 more while it is
/// made), and per call 1.5 kB a node; 5 kB more, and a factor of its own, where that is renewed.
class EquilibriumSolver {
 public:
  /// @throws Error as check_model()
  explicit EquilibriumSolver(SolidModel model, EquilibriumSettings settings = {});
  ~EquilibriumSolver();
  EquilibriumSolver(EquilibriumSolver&&) noexcept;
  EquilibriumSolver& operator=(EquilibriumSolver&&) noexcept;

  [[nodiscard]] const SolidModel& model() const;
  [[nodiscard]] const SolverSetup& setup() const;

  /// States at `levels` of `full_load`, from the undeformed body on. Increments that fail are cut
  /// into smaller ones; where that does not help either, the path ends at the last good level and
  /// says why: that is an answer, not an error.
  /// @param full_load  (3 x N) N at level 1; may be zero if there are fixed displacements
  /// @param levels     > 0, increasing; may be empty
  /// @throws Error if the load is zero, not finite, or acts on held nodes only
  /// @throws ContractViolation for a load of the wrong size or levels that do not increase
  [[nodiscard]] PathResult solve_path(const Eigen::Matrix3Xd& full_load,
                                      std::span<const double> levels,
                                      const PathOptions& options = {}) const;

  /// The load at which the patch has given way by `wanted_press`: a with
  /// sum(unit_load . u(a unit_load)) = wanted_press, the displacement conjugate to the load
  /// (for patch_force(): the weighted mean displacement of the patch along the direction).
  /// Goes there in steps of the press and closes in with warm-started solves; to 1e-6 relative.
  /// Needs supports that stay (Error otherwise): a model without fixed displacements, or a preload.
  /// @param wanted_press  m, > 0
  /// @throws Error as solve_path()
  [[nodiscard]] LoadSearch find_load(const Eigen::Matrix3Xd& unit_load, double wanted_press,
                                     const PathOptions& options = {}) const;

  /// find_load() and then solve_path(), for less than the two: the search goes in steps of the
  /// press to three digits only, and the path's states are interpolated between those first.
  ///
  /// A body that yields, buckles or would turn an element inside out before the goal is solved up
  /// to a little less than what it reaches, with `reached` false. The full load is lowered until
  /// the press grows strictly with every level. No steps: not even a small part of it is borne.
  /// @throws Error as find_load()
  [[nodiscard]] PressPath press_path(const Eigen::Matrix3Xd& unit_load, const PressGoal& goal,
                                     const PathOptions& options = {}) const;

  /// The beginning of a path: du/dlevel at level 0, where supports stand still; the solution of
  /// K du = load with K the tangent there.
  /// @return (3 x N) m, its residual below EquilibriumSettings::tolerance of the load
  /// @throws Error as find_load(), and if conjugate gradients do not converge
  [[nodiscard]] Eigen::Matrix3Xd linear_response(const Eigen::Matrix3Xd& load,
                                                 const PathOptions& options = {}) const;

  /// Forces that hold the body in the state u: d/du of the stored energy, (3 x N) N. At held nodes
  /// of an equilibrium: the reactions plus the load applied there.
  /// @throws Error if an element is inverted under u
  [[nodiscard]] Eigen::Matrix3Xd internal_force(const Eigen::Matrix3Xd& u) const;

  /// Energy stored in the state u, J; infinite if an element is inverted.
  [[nodiscard]] double stored_energy(const Eigen::Matrix3Xd& u) const;

  /// (3 x N) the directional derivative of internal_force at u along du, held nodes taken as at
  /// rest: du there is ignored and the result is 0. This is the tangent that Newton's method uses.
  [[nodiscard]] Eigen::Matrix3Xd tangent_times(const Eigen::Matrix3Xd& u,
                                               const Eigen::Matrix3Xd& du) const;

  struct Core;  ///< what the calls share; internal to this module: solver_core.h

 private:
  std::unique_ptr<const Core> core_;
};

}  // namespace palpable
