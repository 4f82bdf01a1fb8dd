#include "palpable/bake/press_solver.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;

bool moves_supports(const SolidModel& model) {
  const std::vector<HeldComponent> held = held_components(model);
  return std::any_of(held.begin(), held.end(),
                     [](const HeldComponent& h) { return h.displacement != 0.0; });
}

SolidModel unmoved(SolidModel model) {
  model.fixed_displacement.resize(3, 0);
  for (Support& support : model.supports) support.displacement.setZero();
  return model;
}

}  // namespace

PressSolver::PressSolver(const EquilibriumSolver& solver, const Matrix3Xd& preload)
    : solver_(solver) {
  const auto N = static_cast<Eigen::Index>(solver.model().mesh.node_count());
  PALPABLE_EXPECT(preload.cols() == 0 || preload.cols() == N, "a force for each node");
  rest_ = Matrix3Xd::Zero(3, N);
  const bool moved = moves_supports(solver.model());
  if (!moved && (preload.cols() == 0 || preload.isZero(0.0))) return;
  if (moved) unmoved_ = std::make_unique<EquilibriumSolver>(unmoved(solver.model()));
  preload_ = preload.cols() > 0 ? preload : rest_;
  PathResult path = solve(rest_);
  if (!path.complete) {
    throw Error(
        fmt::format("the body cannot bear what acts on it before it is pressed (gravity, "
                    "pressures, moved supports): {}",
                    path.why_stopped));
  }
  rest_ = std::move(path.steps.back().displacement);
}

PathResult PressSolver::solve(const Matrix3Xd& press) const {
  // Half way first: the second step then starts on a line through two states.
  PathResult path = solver_.solve_path(preload_ + press, std::array{0.5, 1.0});
  if (!path.complete) return path;
  path.steps[1].newton_steps += path.steps[0].newton_steps;
  path.steps[1].cg_iterations += path.steps[0].cg_iterations;
  path.steps.erase(path.steps.begin());
  return path;
}

PathResult PressSolver::solve_path(const Matrix3Xd& full_load,
                                   std::span<const double> levels) const {
  if (!is_preloaded()) return solver_.solve_path(full_load, levels);
  PathResult path;
  path.complete = true;
  double last = 0.0;
  for (const double level : levels) {
    PALPABLE_EXPECT(level > last, "levels are above 0 and increase");
    PathResult state = solve(level * full_load);
    path.factors += state.factors;
    path.halvings += state.halvings;
    if (!state.complete) {
      path.complete = false;
      path.stop = state.stop;
      path.why_stopped = fmt::format(
          "load level {:.6g} on top of the preload was not reached, the last that was "
          "is {:.6g}: {}",
          level, last, state.why_stopped);
      break;
    }
    path.steps.push_back(std::move(state.steps.back()));
    path.steps.back().level = last = level;
  }
  return path;
}

LoadSearch PressSolver::find_load(const Matrix3Xd& unit_load, double wanted_press) const {
  if (!is_preloaded()) return solver_.find_load(unit_load, wanted_press);
  struct Point {
    double load, press;
  };
  constexpr double kTolerance = 1e-5;  // of the wanted press; its effect drowns in the mesh's error
  constexpr double kNarrow = 1e-3;     // of the load: so near the last good one the search ends
  constexpr int kMostSolves = 40;

  LoadSearch search;
  // The body without its preload is about as stiff.
  const EquilibriumSolver& plain = unmoved_ ? *unmoved_ : solver_;
  const LoadSearch guess = plain.find_load(unit_load, wanted_press);
  if (!(guess.load > 0.0)) {
    search.stop = guess.stop;
    search.why_stopped = guess.why_stopped;
    return search;
  }
  double load = guess.load;
  std::vector<Point> below{{0.0, 0.0}};  // reached, pressed too little; increasing
  std::optional<Point> above;            // reached, pressed too far
  std::optional<double> out_of_reach;    // the smallest load that has no state
  std::string why;
  while (search.solves < kMostSolves) {
    const PathResult state = solve(load * unit_load);
    ++search.solves;
    if (!state.complete) {
      out_of_reach = load;
      search.stop = state.stop;
      why = state.why_stopped;
    } else {
      const Equilibrium& there = state.steps.back();
      const double press = unit_load.cwiseProduct(there.displacement - rest_).sum();
      const bool arrived = std::abs(press - wanted_press) <= kTolerance * wanted_press;
      if (arrived || (press < wanted_press && load > below.back().load)) {
        search.load = load;
        search.press = press;
        search.state = there;
        search.state.level = load;
      }
      if (arrived) {
        search.reached = true;
        search.stop = Stop::kNone;
        return search;
      }
      if (press > wanted_press) {
        above = {load, press};
      } else if (press > below.back().press && load > below.back().load) {
        below.push_back({load, press});
      } else {
        search.stop = Stop::kNegativeCurvature;
        why = "the press does not grow with the load any more";
        break;
      }
    }
    const Point last = below.back();
    const double end = above ? above->load : out_of_reach.value_or(0.0);
    if (end > 0.0 && end - last.load <= kNarrow * last.load && !above) break;
    // A line through the two nearest states, kept within what is known.
    const Point other = above ? *above : below.size() > 1 ? below[below.size() - 2] : last;
    double next = other.load != last.load
                      ? last.load + (wanted_press - last.press) * (other.load - last.load) /
                                        (other.press - last.press)
                      : 0.5 * load;
    if (end > 0.0) {
      const double width = end - last.load;
      if (!(next > last.load + 1e-6 * width && next < end - 1e-6 * width) ||
          (out_of_reach && !above)) {
        next = 0.5 * (last.load + end);
      }
    } else {
      next = std::min(next, 2.0 * last.load);
    }
    load = next;
  }
  search.why_stopped = fmt::format(
      "a press of {:.4g} mm was not reached, the last good one is {:.4g} mm at {:.4g} N: {}",
      1e3 * wanted_press, 1e3 * search.press, search.load,
      why.empty() ? fmt::format("no load found in {} solves", kMostSolves) : why);
  return search;
}

}  // namespace palpable
