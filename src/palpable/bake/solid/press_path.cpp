#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/lockstep.h"
#include "palpable/bake/solid/solver_core.h"
#include "palpable/bake/solid/walk.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace palpable {

using Eigen::Matrix3Xd;
using Eigen::VectorXd;

namespace {

// Increase of the press per step of a search, ratio to the wanted press; steps that fail are
// shortened anyway.
constexpr double kStride = 1.0 / 6.0;
constexpr int kMostSolves = 100;
// Number of states that a search usually computes; only the reported progress depends on it.
constexpr int kUsualSolves = 8;

// Where a path stops early, this fraction of the last good load becomes the full load. Close to
// collapse a body changes faster than 26 levels can follow: at the bunny's one such site, von Mises
// stress half way between the last two levels is wrong by 5.1e-3 of its maximum with 0.97, 1.5e-3
// with 0.95, 5e-4 with 0.92.
constexpr double kBackOff = 0.95;
// How often the full load may be lowered before the path is given up without states.
constexpr int kMostLowerings = 12;

struct SearchTolerances {
  double on_the_way = 0;  // of the first states, as EquilibriumSettings::tolerance
  double at_the_end = 0;  // of the last states, likewise
  double press = 0;       // of the press, ratio to the wanted one
};

// The known points of the curve of press against load, and the smallest load that is known to press
// too far. Proposes the next load of the search.
class LoadGuess {
 public:
  struct Point {
    double load, press;
  };

  // @param compliance  press over load at rest
  LoadGuess(double wanted, double compliance) : wanted_(wanted), compliance_(compliance) {}

  // The point with the largest press below the wanted one.
  [[nodiscard]] Point last_below() const {
    return *std::max_element(points_.begin(), points_.end(), [&](const Point& a, const Point& b) {
      const auto key = [&](const Point& p) { return p.press < wanted_ ? p.press : -1.0; };
      return key(a) < key(b);
    });
  }

  // Whether the next state may be the wanted one. Within half a stride of the end a state solved
  // to few digits would not help the search.
  [[nodiscard]] bool closes_in() const {
    return above_ || next_press() > (1.0 - 0.5 * kStride) * wanted_;
  }

  [[nodiscard]] double next_load() const {
    const Point below = last_below();
    if (above_) {
      const double load = load_for(wanted_);
      const double width = above_->load - below.load;
      // A guess outside the bracket, or at its very ends, does not shrink it: halve it instead.
      const bool inside = load > below.load + 1e-9 * width && load < above_->load - 1e-9 * width;
      return inside ? load : 0.5 * (below.load + above_->load);
    }
    const double load = load_for(closes_in() ? wanted_ : next_press());
    // An extrapolated load may be too small; on a stable path the press grows with the load.
    return load > below.load ? load : below.load + kStride * wanted_ / compliance_;
  }

  // @returns false if the press has not grown with the load: the point is not kept
  bool add(const Point& here) {
    if (here.press > wanted_) {
      if (!above_ || here.load < above_->load) above_ = here;
    } else if (here.press <= last_below().press) {
      return false;
    }
    points_.push_back(here);
    return true;
  }

 private:
  [[nodiscard]] double next_press() const {
    return std::min(last_below().press + kStride * wanted_, wanted_);
  }

  // The polynomial load(press) through the nearest points.
  [[nodiscard]] double load_for(double press) const {
    if (points_.size() == 1) return press / compliance_;
    std::vector<Point> near = points_;
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
  }

  double wanted_, compliance_;
  std::vector<Point> points_{{0.0, 0.0}};
  std::optional<Point> above_;  // the smallest load known to press too far
};

// Searches along a walk under `unit_load` for the load that presses by `wanted`.
// @param solved  called after each state
LoadSearch search_load(Walk& walk, const Matrix3Xd& unit_load, double wanted,
                       const SearchTolerances& tolerances, const std::function<void()>& solved) {
  LoadSearch search;
  Matrix3Xd at_once;  // linear response, for the first guess; three digits suffice
  walk.linear_response(1e-3, at_once);
  LoadGuess guess(wanted, unit_load.cwiseProduct(at_once).sum());
  const auto stopped = [&](Stop stop, const std::string& why) {
    search.stop = stop;
    search.why_stopped = fmt::format(
        "a press of {:.4g} mm was not reached, the last good one is {:.4g} mm at {:.4g} N: {}",
        1e3 * wanted, 1e3 * search.press, search.load, why);
  };

  while (search.solves < kMostSolves) {
    const bool closes_in = guess.closes_in();
    const bool arrived =
        walk.advance(guess.next_load(), closes_in ? tolerances.at_the_end : tolerances.on_the_way);
    ++search.solves;
    solved();
    search.newton_steps += walk.now().newton_steps;
    search.cg_iterations += walk.now().cg_iterations;
    search.load = walk.now().level;
    search.press = walk.work_conjugate();
    search.state = walk.now();
    if (closes_in && std::abs(search.press - wanted) <= tolerances.press * wanted) {
      search.reached = true;
      search.why_stopped.clear();
      return search;
    }
    // A guess may leave the range before it arrives, and still bracket the wanted press.
    const bool brackets = walk.failure().stop == Stop::kBeyondRange && search.press > wanted;
    if (!arrived && !brackets) {
      stopped(walk.failure().stop, walk.describe_failure());
      return search;
    }
    if (!guess.add({search.load, search.press})) {
      stopped(Stop::kNegativeCurvature,
              "the press does not grow with the load any more: the body has snapped into another "
              "shape");
      return search;
    }
  }
  stopped(Stop::kNoConvergence, fmt::format("no load found in {} solves", kMostSolves));
  return search;
}

void check_press_load(const EquilibriumSolver::Core& core, const Matrix3Xd& unit_load,
                      const PathOptions& options) {
  if (core.moves_supports() && options.preloaded == nullptr) {
    throw Error(
        "a load cannot be searched for while supports move; give fixed displacements of zero");
  }
  core.check_load(unit_load);
}

// Solves the states at equal steps of path.full_load, which is lowered until all of them are found.
void walk_levels(Walk& walk, int levels, double tolerance, PressPath& path,
                 const std::function<void()>& solved) {
  for (int lowering = 0; lowering <= kMostLowerings; ++lowering) {
    walk.return_to_start();
    path.steps.clear();
    path.press = VectorXd::Zero(levels + 1);
    int good = 0;
    for (int l = 1; l <= levels; ++l, ++good) {
      const double level = static_cast<double>(l) / levels;
      if (!walk.advance(level * path.full_load, tolerance)) {
        path.stop = walk.failure().stop;
        path.why_stopped = walk.describe_failure();
        break;
      }
      solved();
      path.newton_steps += walk.now().newton_steps;
      path.cg_iterations += walk.now().cg_iterations;
      path.press[l] = walk.work_conjugate();
      if (!(path.press[l] > path.press[l - 1])) {
        path.stop = Stop::kNegativeCurvature;
        path.why_stopped = "its patch does not give way further as the load grows";
        break;
      }
      path.steps.push_back(walk.now());
      path.steps.back().level = level;
    }
    if (good == levels) return;
    path.reached = false;
    // The last good level becomes the full load; if not even the first one is good, a part of it.
    // Up to the end of the model's range all loads are good, also between two levels.
    const double reached = walk.now().level;
    if (path.stop == Stop::kBeyondRange && reached > 0.0) {
      path.full_load = kBackOff * reached;
    } else {
      path.full_load *= good > 0 ? kBackOff * good / levels : 0.5 / levels;
    }
  }
  path.steps.clear();
  path.full_load = 0.0;
}

}  // namespace

Matrix3Xd EquilibriumSolver::linear_response(const Matrix3Xd& load,
                                             const PathOptions& options) const {
  check_press_load(*core_, load, options);
  Walk walk(*core_, load, options);
  Matrix3Xd du;
  if (!walk.linear_response(core_->settings.tolerance, du)) {
    throw Error(
        "no linear response: the body at rest has too little stiffness for conjugate gradients; "
        "fix more nodes, or mesh slender parts finer");
  }
  return du;
}

LoadSearch EquilibriumSolver::find_load(const Matrix3Xd& unit_load, double wanted_press,
                                        const PathOptions& options) const {
  PALPABLE_EXPECT(wanted_press > 0.0 && std::isfinite(wanted_press), "the press is above 0 m");
  check_press_load(*core_, unit_load, options);
  Walk walk(*core_, unit_load, options);
  const double tolerance = core_->settings.tolerance;
  // 1e-6 of the press is far below the error of the mesh.
  return search_load(walk, unit_load, wanted_press, {tolerance, tolerance, 1e-6}, [] {});
}

PressPath EquilibriumSolver::press_path(const Matrix3Xd& unit_load, const PressGoal& goal,
                                        const PathOptions& options) const {
  PALPABLE_EXPECT(goal.force > 0.0 || goal.press > 0.0, "a press or a force above 0");
  PALPABLE_EXPECT(goal.levels >= 1, "at least one level");
  check_press_load(*core_, unit_load, options);
  const double begin = thread_cpu_seconds();
  const double tolerance = core_->settings.tolerance;
  Walk walk(*core_, unit_load, options);
  PressPath path;
  path.full_load = goal.force;
  path.reached = true;
  int states = 0;
  const auto solved = [&] {
    const double expected = goal.levels + (goal.force > 0.0 ? 0 : kUsualSolves);
    const double part = std::min(1.0, ++states / expected);
    if (options.lane != nullptr) options.lane->report_progress(part);
    if (options.tick) options.tick(part);
  };
  if (!(goal.force > 0.0)) {
    const LoadSearch search = search_load(walk, unit_load, goal.press,
                                          {std::max(tolerance, 1e-3), tolerance, 1e-5}, solved);
    path.full_load = search.reached ? search.load : kBackOff * search.load;
    path.newton_steps = search.newton_steps;
    path.cg_iterations = search.cg_iterations;
    path.reached = search.reached;
    path.stop = search.stop;
    path.why_stopped = search.why_stopped;
  }
  if (path.full_load > 0.0) walk_levels(walk, goal.levels, tolerance, path, solved);
  path.factors = walk.factors();
  path.halvings = walk.halvings();
  path.times = walk.times();
  path.times.total_s = thread_cpu_seconds() - begin;
  return path;
}

}  // namespace palpable
