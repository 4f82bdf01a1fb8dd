#include "palpable/solid/equilibrium.h"

#include "palpable/base/contract.h"
#include "palpable/base/cpu_time.h"
#include "palpable/base/error.h"
#include "palpable/solid/conjugate_gradients.h"
#include "palpable/solid/quasi_newton.h"
#include "palpable/solid/sparse_cholesky.h"
#include "palpable/solid/tet_assembly.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace palpable {

using Eigen::Matrix3Xd;
using Eigen::VectorXd;

namespace {

// What a body can do at rest: its tangent there, factorised; what every call starts with.
struct RestFactor {
  FactorPrecision precision = FactorPrecision::k16Bits;
  CholeskyFactor factor;
};

// Conjugate gradients on K with the factor of K itself, under the body's own weight, sideways too:
// the loads that ask most of what is slender. One or two iterations if the factor is as good as
// exact.
int iterations_with_own_factor(const BlockMatrix& K, const CholeskyFactor& factor,
                               FactorWorkspace& workspace) {
  constexpr double kDigits = 1e-4;
  constexpr int kMost = 20;
  const CgSystem system{
      .K = [&](const VectorXd& x, VectorXd& y) { K.multiply(x, y); },
      .preconditioner = [&](const VectorXd& b,
                            VectorXd& x) { factor.solve_roughly(b, x, workspace); }};
  CgScratch scratch;
  VectorXd x;
  const CgResult cg = conjugate_gradients(system, VectorXd::Ones(3 * K.pattern().rows()), kDigits,
                                          kMost, x, scratch);
  return cg.end == CgEnd::kConverged ? cg.iterations : kMost + 1;
}

RestFactor rest_factor(const TetAssembly& assembly, const CholeskyAnalysis& analysis,
                       FactorWorkspace& workspace, SolverSetup& setup) {
  // Compact bodies take a few, slender ones many with 16 bits.
  constexpr int kGoodEnough = 6;
  BlockMatrix K(assembly.pattern());
  {
    const CpuTimer timer(setup.tangent_s);
    assembly.tangent(Matrix3Xd::Zero(3, assembly.node_count()), K);
  }
  const CpuTimer timer(setup.factor_s);
  setup.factor_flops = analysis.factor_flops();
  for (const FactorPrecision precision : {FactorPrecision::k16Bits, FactorPrecision::k32Bits}) {
    std::optional<CholeskyFactor> factor = CholeskyFactor::make(analysis, K, precision, workspace);
    if (!factor) break;
    if (precision == FactorPrecision::k16Bits &&
        iterations_with_own_factor(K, *factor, workspace) > kGoodEnough) {
      continue;
    }
    setup.factor_bytes = static_cast<double>(factor->bytes());
    return {precision, *std::move(factor)};
  }
  throw Error(
      "the undeformed body can move without resistance: its stiffness is singular although "
      "enough nodes are fixed; parts that hang together by a single node or edge do that, so "
      "mesh the body anew or fix nodes of each part");
}

// Whatever `make` makes, its CPU time added to `seconds`.
template <class Make>
auto timed(double& seconds, const Make& make) {
  const CpuTimer timer(seconds);
  return make();
}

}  // namespace

// What all calls read and none writes.
struct EquilibriumSolver::Shared {
  SolidModel model;
  EquilibriumSettings settings;
  std::vector<HeldComponent> held;
  SolverSetup setup;
  FactorWorkspace workspace;  // of the construction only
  TetAssembly assembly;
  CholeskyAnalysis analysis;
  RestFactor at_rest;

  Shared(SolidModel the_model, EquilibriumSettings the_settings)
      : model(checked(std::move(the_model))),
        settings(the_settings),
        held(held_components(model)),
        assembly(timed(setup.pattern_s, [&] { return TetAssembly(model); })),
        analysis(timed(setup.ordering_s,
                       [&] { return CholeskyAnalysis(assembly.pattern(), workspace); })),
        at_rest(rest_factor(assembly, analysis, workspace, setup)) {
    setup.element_bytes = static_cast<double>(assembly.bytes());
  }

  [[nodiscard]] bool moves_supports() const {
    return std::any_of(held.begin(), held.end(),
                       [](const HeldComponent& h) { return h.displacement != 0.0; });
  }

  static SolidModel checked(SolidModel model) {
    check_model(model);
    if (static_cast<Eigen::Index>(held_components(model).size()) == model.mesh.nodes.size()) {
      throw Error("every node of the body is fixed: nothing is left to solve; fix fewer nodes");
    }
    return model;
  }

  // What the load must be, whoever asks.
  void check_load(const Matrix3Xd& load) const {
    PALPABLE_EXPECT(load.cols() == model.mesh.node_count(), "one force for each node of the body");
    if (!load.allFinite()) throw Error("a nodal force is not finite");
    VectorXd at_free_nodes;
    assembly.gather(load, at_free_nodes);
    if (at_free_nodes.squaredNorm() > 0.0) return;
    if (load.squaredNorm() > 0.0) {
      throw Error(
          "the load acts on fixed nodes only, so nothing would move; put it on nodes that are "
          "free (and in directions that are), or fix fewer");
    }
    if (!moves_supports()) throw Error("the load is zero; give a force");
  }
};

namespace {

// One walk along an equilibrium path: the state so far, and everything that a step needs.
template <class Shared>
class Walk {
 public:
  // Why a solve ended, with what is worth telling.
  struct Failure {
    Stop stop = Stop::kNone;
    int element = -1;         // kInversion
    double volume_ratio = 0;  // kInversion
    double residual = 0;      // kNoConvergence
    explicit operator bool() const { return stop != Stop::kNone; }
  };

  Walk(const Shared& shared, const Matrix3Xd& full_load)
      : shared_(shared),
        assembly_(shared.assembly),
        settings_(shared.settings),
        load_(full_load),
        factor_(&shared.at_rest.factor),
        force_(3, assembly_.node_count()),
        direction_(Matrix3Xd::Zero(3, assembly_.node_count())),
        change_(3, assembly_.node_count()) {
    now_.displacement = Matrix3Xd::Zero(3, assembly_.node_count());
    knots_.push_back({0.0, now_.displacement});
    assembly_.gather(load_, free_load_);
  }

  [[nodiscard]] const Equilibrium& now() const { return now_; }
  [[nodiscard]] const Failure& failure() const { return failure_; }
  [[nodiscard]] int factors() const { return factors_; }
  [[nodiscard]] int halvings() const { return halvings_; }
  [[nodiscard]] const SolveTimes& times() const { return times_; }

  // Goes to `target`, in smaller increments where one does not do. False: now() is the last good
  // state on the way and failure() says why.
  bool advance(double target) {
    newton_steps_ = cg_iterations_ = 0;
    double step = target - now_.level;
    int halvings_in_succession = 0;
    while (now_.level != target) {
      const double left = target - now_.level;
      const double level = std::abs(step) >= std::abs(left) ? target : now_.level + step;
      failure_ = solve(level);
      if (!failure_) {
        if (halvings_in_succession > 0) --halvings_in_succession;
        step *= 2.0;
        continue;
      }
      if (halvings_in_succession == settings_.max_halvings) return false;
      ++halvings_in_succession;
      ++halvings_;
      step = 0.5 * (level - now_.level);
    }
    return true;
  }

  // d press / d load of the undeformed body, m/N.
  double first_compliance() {
    assembly_.gather(load_, r_);
    // A guess to start from: three digits are plenty.
    solve_tangent(now_.displacement, 1e-3);
    return r_.dot(d_);
  }

  [[nodiscard]] std::string describe_failure() const {
    switch (failure_.stop) {
      case Stop::kInversion:
        return fmt::format(
            "element {} would be turned inside out (J = {:.2g}); press less, or mesh the body "
            "finer "
            "there",
            failure_.element, failure_.volume_ratio);
      case Stop::kNegativeCurvature:
        return "the body loses its stiffness there (negative curvature: it buckles or collapses); "
               "press less, or use a law that stiffens under compression (neo-hookean)";
      case Stop::kNoConvergence:
        return fmt::format(
            "Newton's method did not converge in {} steps (relative residual {:.2g}); try more "
            "load "
            "levels",
            settings_.max_newton_steps, failure_.residual);
      case Stop::kLinearSolver:
        return fmt::format(
            "conjugate gradients did not converge in {} iterations (relative residual {:.2g}): the "
            "body is too slender, too nearly incompressible or of too unlike materials for them",
            settings_.max_cg_iterations, failure_.residual);
      case Stop::kNone:
        break;
    }
    return {};
  }

 private:
  struct Knot {
    double level;
    Matrix3Xd u;
  };
  // With 26 levels, each order up to the seventh took half a digit more off the first residual;
  // from there on the solver's own error, amplified by 2^order, eats what is gained.
  static constexpr int kHighestOrder = 7;
  static constexpr std::size_t kKnots = 9;

  void set_supports(double level, Matrix3Xd& u) const {
    for (const HeldComponent& h : shared_.held) u.reshaped()[h.at] = level * h.displacement;
  }

  BodyState force_at(const Matrix3Xd& u) {
    const CpuTimer timer(times_.force_s);
    return assembly_.force(u, force_);
  }

  // Forces at u into force_, the residual at the free nodes into r_.
  BodyState evaluate(double level, const Matrix3Xd& u) {
    const BodyState state = force_at(u);
    if (!std::isfinite(state.energy)) return state;
    update_residual(level);
    return state;
  }

  void update_residual(double level) {
    assembly_.gather(force_, r_);
    const double held = std::max(0.0, force_.squaredNorm() - r_.squaredNorm());
    scale_ = std::max(level * free_load_.norm(), std::sqrt(held));
    r_ = level * free_load_ - r_;
  }

  // Polynomial through the known states nearest to `level`; order 0 is the nearest state.
  Matrix3Xd extrapolated(double level, int order) const {
    Matrix3Xd u = Matrix3Xd::Zero(3, assembly_.node_count());
    for (int i = 0; i <= order; ++i) {
      double weight = 1.0;
      for (int j = 0; j <= order; ++j) {
        if (j == i) continue;
        const double a = knots_[static_cast<std::size_t>(i)].level;
        const double b = knots_[static_cast<std::size_t>(j)].level;
        weight *= (level - b) / (a - b);
      }
      u += weight * knots_[static_cast<std::size_t>(i)].u;
    }
    set_supports(level, u);
    return u;
  }

  // Supports that move drag the body along: the tangent says how. Without this the elements beside
  // them would take the whole motion and be crushed.
  std::optional<Matrix3Xd> dragged(double level) {
    Matrix3Xd du = Matrix3Xd::Zero(3, assembly_.node_count());
    set_supports(level - now_.level, du);
    assembly_.force_change(now_.displacement, du, change_);
    change_ = (level - now_.level) * load_ - change_;
    assembly_.gather(change_, r_);
    const CgResult cg = solve_tangent(now_.displacement, 1e-3);
    if (cg.end != CgEnd::kConverged) return std::nullopt;
    Matrix3Xd u = now_.displacement + du;
    assembly_.add_scattered(d_, 1.0, u);
    return u;
  }

  // The best start that the known states offer, judged by its residual.
  Matrix3Xd predict(double level) {
    std::sort(knots_.begin(), knots_.end(), [&](const Knot& a, const Knot& b) {
      return std::abs(a.level - level) < std::abs(b.level - level);
    });
    if (knots_.size() > kKnots) knots_.resize(kKnots);
    if (knots_.size() == 1 && shared_.moves_supports()) {
      if (auto u = dragged(level)) return *std::move(u);
    }
    const int highest = std::min(kHighestOrder, static_cast<int>(knots_.size()) - 1);
    Matrix3Xd best;
    double best_residual = std::numeric_limits<double>::infinity();
    // The best order is among the highest, unless those turn an element inside out.
    for (int order = highest; order >= 0; --order) {
      if (order < highest - 2 && std::isfinite(best_residual)) break;
      Matrix3Xd u = extrapolated(level, order);
      const bool finite = std::isfinite(evaluate(level, u).energy);
      const double residual = finite ? r_.norm() : std::numeric_limits<double>::infinity();
      if (best.cols() == 0 || residual <= best_residual) {
        best = std::move(u);
        best_residual = residual;
      }
    }
    return best;
  }

  bool renew_factor(const Matrix3Xd& u) {
    if (!K_) K_.emplace(assembly_.pattern());
    {
      const CpuTimer timer(times_.tangent_s);
      assembly_.tangent(u, *K_);
    }
    const CpuTimer timer(times_.factor_s);
    std::optional<CholeskyFactor> fresh =
        CholeskyFactor::make(shared_.analysis, *K_, shared_.at_rest.precision, workspace_);
    if (!fresh) return false;
    own_factor_ = std::move(fresh);
    factor_ = &*own_factor_;
    ++factors_;
    factor_is_slow_ = false;
    return true;
  }

  // d_ with tangent(u) d_ = r_ at what is free.
  CgResult solve_tangent(const Matrix3Xd& u, double relative_tolerance) {
    const CgSystem system{
        .K =
            [&](const VectorXd& x, VectorXd& y) {
              const CpuTimer timer(times_.product_s);
              assembly_.set_free(x, direction_);
              assembly_.force_change(u, direction_, change_);
              assembly_.gather(change_, y);
            },
        .preconditioner =
            [&](const VectorXd& b, VectorXd& x) {
              const CpuTimer timer(times_.precondition_s);
              learnt_.solve(*factor_, b, x, workspace_);
            },
        .visit = [&](const VectorXd& s, const VectorXd& Ks) { learnt_.note(s, Ks); }};
    const CgResult cg = conjugate_gradients(system, r_, relative_tolerance,
                                            settings_.max_cg_iterations, d_, cg_scratch_);
    cg_iterations_ += cg.iterations;
    learnt_.learn();
    return cg;
  }

  // The Newton step at u for the residual r_, into d_.
  Failure newton_step(const Matrix3Xd& u) {
    if (factor_is_slow_ && !renew_factor(u)) return {.stop = Stop::kNegativeCurvature};
    // As exact as the quadratic convergence of Newton's method can use, and not more than the goal
    // needs.
    const double relative = r_.norm() / scale_;
    const double forcing =
        std::max(std::min(0.05, relative), std::min(0.5, 0.3 * settings_.tolerance / relative));
    for (int attempt = 0; attempt < 2; ++attempt) {
      const CgResult cg = solve_tangent(u, forcing);
      if (cg.end == CgEnd::kNegativeCurvature) return {.stop = Stop::kNegativeCurvature};
      if (cg.end == CgEnd::kConverged) {
        factor_is_slow_ = cg.iterations > settings_.refresh_iterations;
        return {};
      }
      if (attempt == 0 && !renew_factor(u)) return {.stop = Stop::kNegativeCurvature};
    }
    return {.stop = Stop::kLinearSolver, .residual = relative};
  }

  // Equilibrium at `level`, from the best prediction; on success it becomes now().
  Failure solve(double level) {
    Matrix3Xd u = predict(level);
    set_supports(level, u);
    BodyState state = evaluate(level, u);
    if (!std::isfinite(state.energy)) return inverted(state);
    Matrix3Xd trial;
    for (int step = 0;; ++step) {
      const double norm = r_.norm();
      // A load so small that rounding is larger than the tolerance is solved to that.
      if (norm <= std::max(settings_.tolerance * scale_, assembly_.force_noise())) {
        accept(level, std::move(u), state, scale_ > 0.0 ? norm / scale_ : 0.0);
        return {};
      }
      if (step == settings_.max_newton_steps) {
        return {.stop = Stop::kNoConvergence, .residual = norm / scale_};
      }
      if (const Failure failure = newton_step(u)) return failure;
      ++newton_steps_;

      // d_ points downhill in the potential, because the tangent was positive along all that
      // conjugate gradients saw. A step is taken if it lowers the potential as Armijo asks, or
      // halves the residual: close to the solution the potential cannot tell any more.
      const double potential = state.energy - level * load_.cwiseProduct(u).sum();
      const double slope = -r_.dot(d_);
      const double rounding = assembly_.energy_noise() + 1e-13 * std::abs(potential);
      BodyState trial_state;
      double share = 1.0;
      for (;; share *= 0.5) {
        trial = u;
        assembly_.add_scattered(d_, share, trial);
        trial_state = force_at(trial);
        if (std::isfinite(trial_state.energy)) {
          const double trial_potential =
              trial_state.energy - level * load_.cwiseProduct(trial).sum();
          update_residual(level);
          if (trial_potential <= potential + 1e-4 * share * slope + rounding) break;
          if (r_.norm() <= 0.5 * norm) break;
        }
        // 2^-20: such a step moves nothing that a picture or a stress would show.
        if (share < 1e-6) {
          if (!std::isfinite(trial_state.energy)) return inverted(trial_state);
          return {.stop = Stop::kNoConvergence, .residual = norm / scale_};
        }
      }
      std::swap(u, trial);
      state = trial_state;
    }
  }

  static Failure inverted(const BodyState& state) {
    return {.stop = Stop::kInversion,
            .element = state.most_compressed,
            .volume_ratio = state.smallest_volume_ratio};
  }

  void accept(double level, Matrix3Xd u, const BodyState& state, double residual) {
    knots_.push_back({level, u});
    now_.displacement = std::move(u);
    now_.level = level;
    now_.newton_steps = newton_steps_;
    now_.cg_iterations = cg_iterations_;
    now_.residual = residual;
    now_.smallest_volume_ratio = state.smallest_volume_ratio;
  }

  const Shared& shared_;
  const TetAssembly& assembly_;
  const EquilibriumSettings& settings_;
  const Matrix3Xd& load_;

  FactorWorkspace workspace_;
  std::optional<BlockMatrix> K_;  // only where the factor is renewed
  const CholeskyFactor* factor_;
  std::optional<CholeskyFactor> own_factor_;
  bool factor_is_slow_ = false;
  QuasiNewton learnt_;
  CgScratch cg_scratch_;
  VectorXd free_load_;  // at what is free, level 1
  VectorXd r_, d_;
  Matrix3Xd force_, direction_, change_;
  double scale_ = 0.0;  // what the residual is relative to, N

  std::vector<Knot>
      knots_;  // known states, the undeformed one first; nearest first after predict()
  Equilibrium now_;
  Failure failure_;
  SolveTimes times_;
  int newton_steps_ = 0, cg_iterations_ = 0, factors_ = 0, halvings_ = 0;
};

}  // namespace

EquilibriumSolver::EquilibriumSolver(SolidModel model, EquilibriumSettings settings)
    : shared_(std::make_unique<const Shared>(std::move(model), settings)) {}
EquilibriumSolver::~EquilibriumSolver() = default;
EquilibriumSolver::EquilibriumSolver(EquilibriumSolver&&) noexcept = default;
EquilibriumSolver& EquilibriumSolver::operator=(EquilibriumSolver&&) noexcept = default;

const SolidModel& EquilibriumSolver::model() const { return shared_->model; }
const SolverSetup& EquilibriumSolver::setup() const { return shared_->setup; }

PathResult EquilibriumSolver::solve_path(const Matrix3Xd& full_load,
                                         std::span<const double> levels) const {
  shared_->check_load(full_load);
  double before = 0.0;
  for (const double level : levels) {
    PALPABLE_EXPECT(level > before && std::isfinite(level), "levels are above 0 and increase");
    before = level;
  }
  const double begin = thread_cpu_seconds();
  Walk walk(*shared_, full_load);
  PathResult path;
  path.steps.reserve(levels.size());
  path.complete = true;
  for (const double level : levels) {
    if (!walk.advance(level)) {
      path.complete = false;
      path.stop = walk.failure().stop;
      path.why_stopped =
          fmt::format("load level {:.6g} was not reached, the last that was is {:.6g}: {}", level,
                      walk.now().level, walk.describe_failure());
      break;
    }
    path.steps.push_back(walk.now());
  }
  path.factors = walk.factors();
  path.halvings = walk.halvings();
  path.times = walk.times();
  path.times.total_s = thread_cpu_seconds() - begin;
  return path;
}

LoadSearch EquilibriumSolver::find_load(const Matrix3Xd& unit_load, double wanted_press) const {
  PALPABLE_EXPECT(wanted_press > 0.0 && std::isfinite(wanted_press), "the press is above 0 m");
  if (shared_->moves_supports()) {
    throw Error(
        "a load cannot be searched for while supports move; give fixed displacements of zero");
  }
  shared_->check_load(unit_load);

  struct Point {
    double load, press;
  };
  constexpr double kTolerance = 1e-6;  // of the wanted press; its effect drowns in the mesh's error
  constexpr double kStride = 1.0 / 6.0;  // of the wanted press per step; failures shorten it anyway
  constexpr int kMostSolves = 100;

  Walk walk(*shared_, unit_load);
  LoadSearch search;
  std::vector<Point> points{{0.0, 0.0}};
  // The next guess comes from the polynomial load(press) through the nearest points.
  const double compliance = walk.first_compliance();
  const auto load_for = [&](double press) {
    if (points.size() == 1) return press / compliance;
    std::vector<Point> near = points;
    std::sort(near.begin(), near.end(), [&](const Point& a, const Point& b) {
      return std::abs(a.press - press) < std::abs(b.press - press);
    });
    if (near.size() > 4) near.resize(4);
    double load = 0.0;
    for (std::size_t i = 0; i < near.size(); ++i) {
      double weight = 1.0;
      for (std::size_t j = 0; j < near.size(); ++j) {
        if (j != i) weight *= (press - near[j].press) / (near[i].press - near[j].press);
      }
      load += weight * near[i].load;
    }
    return load;
  };
  const auto stopped = [&](Stop stop, const std::string& why) {
    search.stop = stop;
    search.why_stopped = fmt::format(
        "a press of {:.4g} mm was not reached, the last good one is {:.4g} mm at {:.4g} N: {}",
        1e3 * wanted_press, 1e3 * search.press, search.load, why);
  };

  std::optional<Point> above;  // the smallest load known to press too far
  while (search.solves < kMostSolves) {
    const Point last_below =
        *std::max_element(points.begin(), points.end(), [&](const Point& a, const Point& b) {
          const auto key = [&](const Point& p) { return p.press < wanted_press ? p.press : -1.0; };
          return key(a) < key(b);
        });
    double load = 0.0;
    if (above) {
      load = load_for(wanted_press);
      const double width = above->load - last_below.load;
      // Guesses outside the bracket, or at its very ends, bring nothing: halve it instead.
      if (!(load > last_below.load + 1e-9 * width && load < above->load - 1e-9 * width)) {
        load = 0.5 * (last_below.load + above->load);
      }
    } else {
      load = load_for(std::min(last_below.press + kStride * wanted_press, wanted_press));
      // An extrapolation may turn back; the press grows with the load on a stable path.
      if (!(load > last_below.load)) load = last_below.load + kStride * wanted_press / compliance;
    }
    const bool arrived = walk.advance(load);
    ++search.solves;
    const Point here{walk.now().level, unit_load.cwiseProduct(walk.now().displacement).sum()};
    search.load = here.load;
    search.press = here.press;
    search.state = walk.now();
    if (std::abs(here.press - wanted_press) <= kTolerance * wanted_press) {
      search.reached = true;
      search.why_stopped.clear();
      return search;
    }
    if (!arrived) {
      stopped(walk.failure().stop, walk.describe_failure());
      return search;
    }
    if (here.press > wanted_press) {
      if (!above || here.load < above->load) above = here;
    } else if (here.press <= last_below.press) {
      stopped(Stop::kNegativeCurvature,
              "the press does not grow with the load any more: the body has snapped into another "
              "shape");
      return search;
    }
    points.push_back(here);
  }
  stopped(Stop::kNoConvergence, fmt::format("no load found in {} solves", kMostSolves));
  return search;
}

Matrix3Xd EquilibriumSolver::internal_force(const Matrix3Xd& u) const {
  PALPABLE_EXPECT(u.cols() == model().mesh.node_count(), "one displacement for each node");
  Matrix3Xd force(3, u.cols());
  const BodyState state = shared_->assembly.force(u, force);
  if (!std::isfinite(state.energy)) {
    throw Error(
        fmt::format("element {} is inverted by the displacement (J = {:.3g}); it has no forces",
                    state.most_compressed, state.smallest_volume_ratio));
  }
  return force;
}

double EquilibriumSolver::stored_energy(const Matrix3Xd& u) const {
  PALPABLE_EXPECT(u.cols() == model().mesh.node_count(), "one displacement for each node");
  Matrix3Xd force(3, u.cols());
  return shared_->assembly.force(u, force).energy;
}

Matrix3Xd EquilibriumSolver::tangent_times(const Matrix3Xd& u, const Matrix3Xd& du) const {
  PALPABLE_EXPECT(u.cols() == model().mesh.node_count() && du.cols() == u.cols(),
                  "one displacement for each node");
  VectorXd x;
  Matrix3Xd free = Matrix3Xd::Zero(3, u.cols()), result(3, u.cols());
  shared_->assembly.gather(du, x);
  shared_->assembly.set_free(x, free);
  shared_->assembly.force_change(u, free, result);
  shared_->assembly.gather(result, x);
  shared_->assembly.set_free(x, free);
  return free;
}

}  // namespace palpable
