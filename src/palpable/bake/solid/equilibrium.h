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
/// Newton's method solves this, from a start extrapolated over the previous levels. Conjugate
/// gradients solve for each Newton step. Their matrix products are loops over the elements; their
/// preconditioner is the Cholesky factor of the undeformed tangent, corrected by what earlier
/// solves have shown of the present one (quasi_newton.h). One factor usually serves all sites of a
/// body. A path that needs too many iterations with it factorises its own present tangent.
#pragma once

#include "palpable/bake/solid/solid_model.h"

#include <Eigen/Core>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace palpable {

class Lane;

/// Tolerances and limits of a solve.
struct EquilibriumSettings {
  /// A state counts as solved when the residual at the free nodes is below this, relative to the
  /// norm of the applied forces, or of the forces at the held nodes if those are larger.
  double tolerance = 1e-8;
  int max_newton_steps = 30;  ///< per increment, before the increment is halved
  /// How often an increment is halved in succession before the path stops.
  int max_halvings = 6;
  /// After a Newton step that took more iterations than this, the path factorises the present
  /// tangent before the next step. On a bunny of 16,000 nodes that costs as much as some 60
  /// iterations, and the factor serves several steps.
  int refresh_iterations = 40;
  /// The same limit for a path in lockstep that still shares the common factor. It is higher,
  /// because a factor of its own shares no pass with other paths. Once the path has one,
  /// refresh_iterations holds.
  int refresh_iterations_in_lockstep = 150;
  /// A path in lockstep that has taken more iterations than this in all gets a factor of its own.
  /// Such a path is close to collapse. With the common factor it would still run after all other
  /// lanes have ended, and pay for whole passes alone. On the dragon six of 32 sites took more than
  /// half of all iterations, the hardest 4,489, the median 340.
  int iterations_in_lockstep = 600;
  /// Per Newton step. When they are used up the factor is renewed and the step is tried once more.
  int max_cg_iterations = 400;
};

/// One step of Newton's method.
struct NewtonStep {
  double residual = 0;    ///< before the step; relative, as EquilibriumSettings::tolerance
  int cg_iterations = 0;  ///< of its linear solve
  double share = 1;       ///< of the full step that the line search accepted: 1, 1/2, 1/4 ...
};

/// One state of the body.
struct Equilibrium {
  Eigen::Matrix3Xd displacement;  ///< (3 x N) m
  double level = 0;
  int newton_steps = 0;              ///< since the previous level
  int cg_iterations = 0;             ///< likewise
  double residual = 0;               ///< relative, as EquilibriumSettings::tolerance
  double smallest_volume_ratio = 1;  ///< min over elements of J = det F
  /// All steps since the previous level, including those of increments that failed.
  std::vector<NewtonStep> convergence = {};
};

/// Why a solve ended early.
enum class Stop {
  kNone,
  kInversion,          ///< every shortened step turns an element inside out
  kNegativeCurvature,  ///< the tangent is not positive definite: the body buckles or collapses
  kNoConvergence,      ///< Newton's method ran out of steps
  kLinearSolver,       ///< conjugate gradients ran out of iterations, with a fresh factor too
  kSwallowed,   ///< an obstacle, or another body, got inside the body, where nothing pushes it
                ///< out (contact.h)
  kBeyondRange  ///< a node would move by more than SolidModel::largest_displacement
};

/// CPU time of the parts of a path, s.
struct SolveTimes {
  double factor_s = 0;        ///< factors that were renewed on the way
  double tangent_s = 0;       ///< tangents assembled for them
  double precondition_s = 0;  ///< solves with the factor and the corrections of quasi_newton.h
  double product_s = 0;       ///< tangent times vector
  double force_s = 0;         ///< forces, that is residuals
  double total_s = 0;         ///< everything, including what no line above counts
};

/// CPU time (s) of a solver's construction, and the size of its factor.
struct SolverSetup {
  double pattern_s = 0;      ///< element blocks, neighbours
  double ordering_s = 0;     ///< order of elimination and structure of the factor
  double tangent_s = 0;      ///< tangent of the undeformed body
  double factor_s = 0;       ///< its factor
  double factor_flops = 0;   ///< of one factorisation
  double factor_bytes = 0;   ///< size of the factor; a solve reads it twice
  double element_bytes = 0;  ///< read by one pass over the elements
};

/// A path as far as it could be solved.
struct PathResult {
  std::vector<Equilibrium> steps;  ///< one per level reached, in order
  bool complete = false;           ///< all levels reached
  Stop stop = Stop::kNone;
  std::string why_stopped;  ///< empty when complete: one line, with the last good level
  int factors = 0;          ///< how often the factor was renewed on the way
  int halvings = 0;         ///< increments that had to be cut
  SolveTimes times;
};

/// Loads that act before a path begins, and the state in which they leave the body.
struct Preloaded {
  Eigen::Matrix3Xd force;  ///< (3 x N) N
  /// (3 x N) m: in equilibrium with `force`, supports moved all the way.
  Eigen::Matrix3Xd rest;
};

/// Options of a path.
struct PathOptions {
  /// The path starts from this state. Its force acts in full all along the path, and supports stay
  /// where they are. Levels and presses are counted from there. nullptr: the undeformed body.
  const Preloaded* preloaded = nullptr;
  /// m: how far a node may move, instead of SolidModel::largest_displacement; 0: that.
  double range = 0;
  /// Solves share each pass through the factor with other lanes (lockstep.h). nullptr: no sharing.
  Lane* lane = nullptr;
  /// press_path() calls this after each state with the fraction of its work that is done, 0 .. 1.
  std::function<void(double part)> tick = {};
};

/// Result of find_load().
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

/// How far a body is to be pressed, and in how many steps.
struct PressGoal {
  double press = 0;  ///< m: sum(unit_load . u) at the full load, > 0
  double force = 0;  ///< N: the full load, if above 0; then `press` is ignored
  int levels = 10;   ///< L >= 1: equal steps of the load
};

/// A path up to the load that reaches a PressGoal.
struct PressPath {
  double full_load = 0;            ///< N
  std::vector<Equilibrium> steps;  ///< (L) at level 1/L .. 1 of full_load
  Eigen::VectorXd press;           ///< (L + 1) m: 0 and sum(unit_load . u) of each, increasing
  bool reached = false;            ///< the press, or the force
  Stop stop = Stop::kNone;
  std::string why_stopped;                  ///< empty when reached
  int newton_steps = 0, cg_iterations = 0;  ///< including the search
  int factors = 0;                          ///< how often the factor was renewed
  int halvings = 0;                         ///< increments that had to be cut
  SolveTimes times;
};

/// Memory of a call, bytes for each node of the mesh: the pairs of quasi_newton.h and the vectors.
/// Measured: 1,200 to 1,300 on a block of 17,000 nodes. The states that a call returns are not in
/// it.
inline constexpr double kBytesPerNodeOfCall = 1500;

/// The solver of one model. It makes pattern, shape gradients and the factor of the undeformed
/// tangent once; every call has its own workspace. Several threads may call const members of one
/// object at once (one site each); a call itself uses one thread.
///
/// Memory on a bunny of 16,000 nodes: 4 kB a node for the factor (8 kB in 32 bits; 8 kB more while
/// it is made), and kBytesPerNodeOfCall for each call. A call that renews the factor needs 5 kB a
/// node more, and a factor.
class EquilibriumSolver {
 public:
  /// @throws Error as check_model()
  explicit EquilibriumSolver(SolidModel model, EquilibriumSettings settings = {});
  ~EquilibriumSolver();
  EquilibriumSolver(EquilibriumSolver&&) noexcept;
  EquilibriumSolver& operator=(EquilibriumSolver&&) noexcept;

  [[nodiscard]] const SolidModel& model() const;
  [[nodiscard]] const SolverSetup& setup() const;

  /// States at `levels` of `full_load`, beginning at the undeformed (or preloaded) body. An
  /// increment that fails is halved. Where that does not help, the path ends at the last good level
  /// and PathResult says why; that is not an error.
  /// @param full_load  (3 x N) N at level 1; may be zero if there are fixed displacements
  /// @param levels     > 0, increasing; may be empty
  /// @throws Error if the load is zero, not finite, or acts on held nodes only
  /// @throws ContractViolation for a load of the wrong size or levels that do not increase
  [[nodiscard]] PathResult solve_path(const Eigen::Matrix3Xd& full_load,
                                      std::span<const double> levels,
                                      const PathOptions& options = {}) const;

  /// The load that presses by `wanted_press`: the a with
  ///
  ///     sum(unit_load . u(a unit_load)) = wanted_press       to 1e-6 of wanted_press
  ///
  /// The left side is the displacement conjugate to the load; for patch_force() it is the weighted
  /// mean displacement of the patch along the direction. The search first raises the press step by
  /// step, then interpolates between the states that it has. Supports must not move with the level:
  /// the model has no fixed displacements, or options.preloaded has applied them.
  /// @param wanted_press  m, > 0
  /// @throws Error as solve_path()
  [[nodiscard]] LoadSearch find_load(const Eigen::Matrix3Xd& unit_load, double wanted_press,
                                     const PathOptions& options = {}) const;

  /// The result of find_load() followed by solve_path(), at a lower cost: the search finds the load
  /// to three digits only, and the states of the path start from interpolations between those of
  /// the search.
  ///
  /// A body that yields, buckles or would turn an element inside out before the goal is solved up
  /// to 95 % of the largest load that was reached, with `reached` false. The full load is lowered
  /// until the press grows strictly with every level. `steps` is empty when not even a small part
  /// of it can be reached.
  /// @throws Error as find_load()
  [[nodiscard]] PressPath press_path(const Eigen::Matrix3Xd& unit_load, const PressGoal& goal,
                                     const PathOptions& options = {}) const;

  /// The slope of a path at its beginning, du/dlevel at level 0 with supports at rest: the solution
  /// of K du = load, K the tangent there.
  /// @return (3 x N) m, its residual below EquilibriumSettings::tolerance of the load
  /// @throws Error as find_load(), and if conjugate gradients do not converge
  [[nodiscard]] Eigen::Matrix3Xd linear_response(const Eigen::Matrix3Xd& load,
                                                 const PathOptions& options = {}) const;

  /// (3 x N) N, the forces that hold the body in the state u: d/du of the stored energy. At the
  /// held nodes of an equilibrium they are the reactions plus the load applied there.
  /// @throws Error if an element is inverted under u
  [[nodiscard]] Eigen::Matrix3Xd internal_force(const Eigen::Matrix3Xd& u) const;

  /// Energy stored in the state u, J; infinite if an element is inverted.
  [[nodiscard]] double stored_energy(const Eigen::Matrix3Xd& u) const;

  /// (3 x N) N, the derivative of internal_force at u along du (3 x N, m): the tangent that
  /// Newton's method uses. At held nodes du is ignored and the result is 0.
  [[nodiscard]] Eigen::Matrix3Xd tangent_times(const Eigen::Matrix3Xd& u,
                                               const Eigen::Matrix3Xd& du) const;

  struct Core;  ///< what all calls share (solver_core.h); internal to this module
  [[nodiscard]] const Core& core() const { return *core_; }

 private:
  std::unique_ptr<const Core> core_;
};

}  // namespace palpable
