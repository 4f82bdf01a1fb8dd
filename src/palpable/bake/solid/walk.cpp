#include "palpable/bake/solid/walk.h"

#include "palpable/bake/solid/displacement_range.h"
#include "palpable/bake/solid/lockstep.h"
#include "palpable/common/base/cpu_time.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

namespace palpable {

using Eigen::Matrix3Xd;
using Eigen::VectorXd;

namespace {

// Highest order of the extrapolation. With 26 levels, each order up to the seventh lowers the first
// residual by half a digit; beyond, the solver's own error, amplified by 2^order, is larger than
// the gain.
constexpr int kHighestOrder = 7;
constexpr std::size_t kMostKnots = 9;  // states kept for it

// Levels this close must not both be used: a polynomial through their states would follow their
// errors.
bool is_close(double a, double b) { return std::abs(a - b) < 1e-3 * std::max(a, b); }

bool softens_under_compression(const SolidModel& model) {
  const auto softens = [](const Material& material) {
    return std::holds_alternative<SaintVenantKirchhoff>(material);
  };
  return softens(model.material) ||
         std::any_of(model.groups.begin(), model.groups.end(),
                     [&](const MaterialGroup& group) { return softens(group.material); });
}

Walk::Failure inverted(const BodyState& state) {
  return {.stop = Stop::kInversion,
          .element = state.most_compressed,
          .volume_ratio = state.smallest_volume_ratio};
}

}  // namespace

Walk::Walk(const EquilibriumSolver::Core& core, const Matrix3Xd& load, const PathOptions& options)
    : core_(core),
      assembly_(core.assembly),
      settings_(core.settings),
      load_(load),
      preloaded_(options.preloaded),
      lane_(options.lane),
      range_(options.range > 0.0 ? options.range : core.model.largest_displacement),
      supports_grow_(preloaded_ == nullptr && core.moves_supports()),
      factor_(&core.at_rest.factor),
      force_(3, assembly_.node_count()) {
  assembly_.gather(load_, free_load_);
  if (preloaded_ != nullptr) {
    start_.displacement = preloaded_->rest;
    assembly_.gather(preloaded_->force, free_preload_);
  } else {
    start_.displacement = Matrix3Xd::Zero(3, assembly_.node_count());
    free_preload_ = VectorXd::Zero(free_load_.size());
  }
  now_ = start_;
  knots_.push_back({0.0, now_.displacement});
}

double Walk::work_conjugate() const {
  return load_.cwiseProduct(now_.displacement - start_.displacement).sum();
}

bool Walk::advance(double target, double tolerance) {
  convergence_.clear();
  cg_iterations_ = 0;
  double step = target - now_.level;
  int halvings_in_succession = 0;
  while (now_.level != target) {
    const double left = target - now_.level;
    const double level = std::abs(step) >= std::abs(left) ? target : now_.level + step;
    failure_ = solve(level, tolerance);
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

void Walk::return_to_start() {
  for (Knot& knot : knots_) {
    if (knot.level != 0.0) guides_.push_back(std::move(knot));
  }
  knots_.clear();
  knots_.push_back({0.0, start_.displacement});
  now_ = start_;
}

bool Walk::linear_response(double tolerance, Matrix3Xd& du) {
  assembly_.gather(load_, r_);
  const CgResult cg = solve_tangent(now_.displacement, tolerance);
  du.setZero(3, assembly_.node_count());
  assembly_.add_scattered(d_, 1.0, du);
  return cg.end == CgEnd::kConverged;
}

std::string Walk::describe_failure() const {
  switch (failure_.stop) {
    case Stop::kInversion:
      return fmt::format(
          "element {} would be turned inside out (J = {:.2g}); press less, or mesh the body "
          "finer "
          "there",
          failure_.element, failure_.volume_ratio);
    case Stop::kNegativeCurvature:
      return describe_collapse();
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
    case Stop::kBeyondRange:
      return beyond_range_text(range_);
    case Stop::kSwallowed:  // with an obstacle only (contact.h)
    case Stop::kNone:
      break;
  }
  return {};
}

std::string Walk::describe_collapse() const {
  if (auto text = expansion_text(core_.model.mesh, now_.displacement)) return *std::move(text);
  std::string why =
      "the body loses its stiffness there (negative curvature: it buckles or collapses); press "
      "less";
  if (softens_under_compression(core_.model)) {
    why += ", or use a law that stiffens under compression (neo-hookean)";
  }
  return why;
}

void Walk::set_supports(double level, Matrix3Xd& u) const {
  const double share = supports_grow_ ? level : 1.0;
  for (const HeldComponent& h : core_.held) u.reshaped()[h.at] = share * h.displacement;
}

BodyState Walk::force_at(const Matrix3Xd& u) {
  const CpuTimer timer(times_.force_s);
  assembly_.set_state(u, fields_);
  return assembly_.force(fields_, force_);
}

// Writes the forces at u to force_, and the residual in the free directions to r_.
BodyState Walk::evaluate(double level, const Matrix3Xd& u) {
  const BodyState state = force_at(u);
  if (!std::isfinite(state.energy)) return state;
  update_residual(level);
  return state;
}

void Walk::update_residual(double level) {
  assembly_.gather(force_, r_);
  const double held = std::max(0.0, force_.squaredNorm() - r_.squaredNorm());
  r_ = free_preload_ + level * free_load_ - r_;
  scale_ = std::max((free_preload_ + level * free_load_).norm(), std::sqrt(held));
}

double Walk::load_potential(double level, const Matrix3Xd& u) const {
  const double of_load = -level * load_.cwiseProduct(u).sum();
  return preloaded_ == nullptr ? of_load : of_load - preloaded_->force.cwiseProduct(u).sum();
}

// The value at `level` of the polynomial through the first order + 1 knots.
Matrix3Xd Walk::through(const std::vector<const Knot*>& knots, double level, int order) const {
  Matrix3Xd u = Matrix3Xd::Zero(3, assembly_.node_count());
  for (int i = 0; i <= order; ++i) {
    const Knot& knot = *knots[i];
    double weight = 1.0;
    for (int j = 0; j <= order; ++j) {
      if (j == i) continue;
      const double other = knots[j]->level;
      weight *= (level - other) / (knot.level - other);
    }
    u += weight * knot.u;
  }
  set_supports(level, u);
  return u;
}

// The state at `level` to first order, when supports move: they drag the body along. A start that
// moved the supports alone would crush the elements beside them.
std::optional<Matrix3Xd> Walk::dragged(double level) {
  Matrix3Xd du = Matrix3Xd::Zero(3, assembly_.node_count());
  set_supports(level - now_.level, du);
  Matrix3Xd change(3, du.cols());
  assembly_.set_state(now_.displacement, fields_);
  assembly_.force_change(fields_, du, change);
  change = (level - now_.level) * load_ - change;
  assembly_.gather(change, r_);
  const CgResult cg = solve_tangent(now_.displacement, 1e-3);
  if (cg.end != CgEnd::kConverged) return std::nullopt;
  Matrix3Xd u = now_.displacement + du;
  assembly_.add_scattered(d_, 1.0, u);
  return u;
}

// The start with the smallest residual, of several polynomials through the known states.
Matrix3Xd Walk::predict(double level) {
  if (knots_.size() == 1 && supports_grow_) {
    if (auto u = dragged(level)) return *std::move(u);
  }
  const auto nearer = [&](const Knot& a, const Knot& b) {
    return std::abs(a.level - level) < std::abs(b.level - level);
  };
  std::sort(knots_.begin(), knots_.end(), nearer);
  if (knots_.size() > kMostKnots) knots_.resize(kMostKnots);
  std::vector<const Knot*> own, with_guides;
  for (const Knot& knot : knots_) own.push_back(&knot);
  with_guides = own;
  for (const Knot& guide : guides_) {
    const bool is_new =
        std::none_of(with_guides.begin(), with_guides.end(),
                     [&](const Knot* other) { return is_close(other->level, guide.level); });
    if (is_new) with_guides.push_back(&guide);
  }
  std::sort(with_guides.begin(), with_guides.end(),
            [&](const Knot* a, const Knot* b) { return nearer(*a, *b); });

  Matrix3Xd best;
  double best_residual = std::numeric_limits<double>::infinity();
  const auto try_order = [&](const std::vector<const Knot*>& knots, int order) {
    Matrix3Xd u = through(knots, level, order);
    const bool finite = std::isfinite(evaluate(level, u).energy);
    const double residual = finite ? r_.norm() : std::numeric_limits<double>::infinity();
    if (best.cols() == 0 || residual <= best_residual) {
      best = std::move(u);
      best_residual = residual;
    }
  };
  const auto highest_order = [](const std::vector<const Knot*>& knots) {
    return std::min(kHighestOrder, static_cast<int>(knots.size()) - 1);
  };
  // Guides lie on both sides of the level, but were solved to few digits.
  if (with_guides.size() > own.size()) try_order(with_guides, highest_order(with_guides));
  // The best order is one of the highest three, unless those turn an element inside out.
  const int highest = highest_order(own);
  for (int order = highest; order >= 0; --order) {
    if (order < highest - 2 && std::isfinite(best_residual)) break;
    try_order(own, order);
  }
  return best;
}

bool Walk::renew_factor(const Matrix3Xd& u) {
  if (!K_) K_.emplace(assembly_.pattern());
  {
    const CpuTimer timer(times_.tangent_s);
    assembly_.set_state(u, fields_);
    assembly_.tangent(fields_, *K_);
  }
  const CpuTimer timer(times_.factor_s);
  std::optional<CholeskyFactor> fresh =
      CholeskyFactor::make(core_.analysis, *K_, core_.at_rest.precision, workspace_);
  if (!fresh) return false;
  own_factor_ = std::move(fresh);
  factor_ = &*own_factor_;
  ++factors_;
  factor_is_slow_ = false;
  return true;
}

// Solves tangent(u) d_ = r_ in the free directions.
CgResult Walk::solve_tangent(const Matrix3Xd& u, double relative_tolerance) {
  const auto apply_factor = [&](const VectorXd& b, VectorXd& x) {
    if (lane_ != nullptr && !own_factor_) {
      lane_->solve(*factor_, b, x);
    } else {
      factor_->solve_roughly(b, x, workspace_);
    }
  };
  assembly_.set_state(u, fields_);
  const CgSystem system{
      .K =
          [&](const VectorXd& x, VectorXd& y) {
            const CpuTimer timer(times_.product_s);
            assembly_.tangent_product(fields_, x, y);
          },
      .preconditioner =
          [&](const VectorXd& b, VectorXd& x) {
            const CpuTimer timer(times_.precondition_s);
            corrections_.solve(b, x, apply_factor);
          },
      .visit = [&](const VectorXd& s, const VectorXd& Ks) { corrections_.record(s, Ks); }};
  const CgResult cg = conjugate_gradients(system, r_, relative_tolerance,
                                          settings_.max_cg_iterations, d_, cg_scratch_);
  cg_iterations_ += cg.iterations;
  all_iterations_ += cg.iterations;
  corrections_.use_recorded();
  return cg;
}

// Computes d_, the Newton step at u for the residual r_.
Walk::Failure Walk::newton_step(const Matrix3Xd& u, double tolerance) {
  if (factor_is_slow_ && !renew_factor(u)) return {.stop = Stop::kNegativeCurvature};
  // The relative error of the step: small enough for quadratic convergence of Newton's method, and
  // not smaller than the tolerance needs.
  const double relative = r_.norm() / scale_;
  const double forcing =
      std::max(std::min(0.05, relative), std::min(0.5, 0.3 * tolerance / relative));
  for (int attempt = 0; attempt < 2; ++attempt) {
    const CgResult cg = solve_tangent(u, forcing);
    if (cg.end == CgEnd::kNegativeCurvature) return {.stop = Stop::kNegativeCurvature};
    if (cg.end == CgEnd::kConverged) {
      const bool shares = lane_ != nullptr && !own_factor_;
      factor_is_slow_ = cg.iterations > (shares ? settings_.refresh_iterations_in_lockstep
                                                : settings_.refresh_iterations) ||
                        (shares && all_iterations_ > settings_.iterations_in_lockstep);
      return {};
    }
    if (attempt == 0 && !renew_factor(u)) return {.stop = Stop::kNegativeCurvature};
  }
  return {.stop = Stop::kLinearSolver, .residual = relative};
}

// Finds equilibrium at `level`, from predict(level). On success it becomes now().
Walk::Failure Walk::solve(double level, double tolerance) {
  Matrix3Xd u = predict(level);
  set_supports(level, u);
  BodyState state = evaluate(level, u);
  if (!std::isfinite(state.energy)) return inverted(state);
  Matrix3Xd trial;
  for (int step = 0;; ++step) {
    const double norm = r_.norm();
    // Where the load is so small that rounding exceeds the tolerance, rounding ends the iteration.
    if (norm <= std::max(tolerance * scale_, assembly_.force_noise())) {
      if (largest_movement(core_.held, u) > range_) return {.stop = Stop::kBeyondRange};
      move_to(level, std::move(u), state, scale_ > 0.0 ? norm / scale_ : 0.0);
      return {};
    }
    if (step == settings_.max_newton_steps) {
      return {.stop = Stop::kNoConvergence, .residual = norm / scale_};
    }
    const int iterations_before = cg_iterations_;
    if (const Failure failure = newton_step(u, tolerance)) return failure;
    const int iterations = cg_iterations_ - iterations_before;

    // d_ is a descent direction of the potential, because the tangent was positive along all search
    // directions of conjugate gradients. A step is accepted if it satisfies Armijo's condition, or
    // if it halves the residual: close to the solution the potential changes by less than its
    // rounding error.
    const double potential = state.energy + load_potential(level, u);
    const double slope = -r_.dot(d_);
    const double rounding = assembly_.energy_noise() + 1e-13 * std::abs(potential);
    BodyState trial_state;
    double share = 1.0;
    for (;; share *= 0.5) {
      trial = u;
      assembly_.add_scattered(d_, share, trial);
      trial_state = force_at(trial);
      if (std::isfinite(trial_state.energy)) {
        const double trial_potential = trial_state.energy + load_potential(level, trial);
        update_residual(level);
        if (trial_potential <= potential + 1e-4 * share * slope + rounding) break;
        if (r_.norm() <= 0.5 * norm) break;
      }
      // Twenty halvings: so small a step changes nothing that matters.
      if (share < 1e-6) {
        if (!std::isfinite(trial_state.energy)) return inverted(trial_state);
        return {.stop = Stop::kNoConvergence, .residual = norm / scale_};
      }
    }
    convergence_.push_back({scale_ > 0.0 ? norm / scale_ : 0.0, iterations, share});
    std::swap(u, trial);
    state = trial_state;
  }
}

void Walk::move_to(double level, Matrix3Xd u, const BodyState& state, double residual) {
  std::erase_if(knots_, [&](const Knot& knot) { return is_close(knot.level, level); });
  knots_.push_back({level, u});
  now_.displacement = std::move(u);
  now_.level = level;
  now_.newton_steps = static_cast<int>(convergence_.size());
  now_.convergence = convergence_;
  now_.cg_iterations = cg_iterations_;
  now_.residual = residual;
  now_.smallest_volume_ratio = state.smallest_volume_ratio;
}

}  // namespace palpable
