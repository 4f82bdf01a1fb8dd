#include "palpable/bake/site_run.h"

#include "palpable/bake/body_problem.h"
#include "palpable/base/contract.h"
#include "palpable/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::VectorXd;

// A site that stops early is taken this fraction of the way: the very last state that the solver
// found is often its last because the next is none.
constexpr double kBackOff = 0.97;
// How often a site's load may be lowered before we say that it cannot be pressed.
constexpr int kMaxLowerings = 12;
// Sites of a batch.
constexpr int kBatch = 1;

// Index of the first level whose press depth does not exceed the one before; L + 1 if there is
// none.
Index first_not_growing(const VectorXd& depth) {
  Index l = 1;
  while (l < depth.size() && depth[l] > depth[l - 1]) ++l;
  return l;
}

class SiteRun {
 public:
  SiteRun(const SiteSolver& solver, const Site& site, const SiteRunSettings& settings,
          StageTimes& times)
      : solver_(solver), settings_(settings), times_(times) {
    unit_load_ =
        unit_load(site, solver.boundary(), solver.presses().solver().model().mesh.node_count());
  }

  // The load to which this site will be pressed.
  void find_load() {
    if (settings_.force > 0.0) {
      result_.full_load = settings_.force;
      return;
    }
    const StageTimer timer(times_, "load search");
    const LoadSearch search = solver_.presses().find_load(unit_load_, settings_.press);
    result_.full_load = search.load;
    result_.outcome.reached_press = search.reached;
    result_.outcome.press = search.press;
    if (!search.reached) {
      result_.full_load *= kBackOff;
      result_.outcome.shortfall = search.why_stopped;
    }
  }

  // States and stresses at all levels; lowers the load where the path does not go through.
  SiteSnapshots solve() {
    const double wanted = result_.full_load;
    for (int lowering = 0; lowering < kMaxLowerings; ++lowering) {
      if (!(result_.full_load > 0.0)) break;
      if (try_path()) {
        compute_stress();
        return std::move(result_);
      }
    }
    throw Error(fmt::format("cannot be pressed with a load between 0 and {:.3g} N: {}", wanted,
                            result_.outcome.shortfall));
  }

 private:
  bool try_path() {
    const StageTimer timer(times_, "solve");
    const int L = settings_.levels;
    std::vector<double> levels;
    for (int l = 1; l <= L; ++l) levels.push_back(static_cast<double>(l) / L);
    const Matrix3Xd full = result_.full_load * unit_load_;
    PathResult path = solver_.presses().solve_path(full, levels);
    const auto solved = static_cast<Index>(path.steps.size());
    VectorXd depth = VectorXd::Zero(solved + 1);
    for (Index l = 1; l <= solved; ++l) {
      const Equilibrium& state = path.steps[static_cast<std::size_t>(l - 1)];
      depth[l] = unit_load_.cwiseProduct(state.displacement - solver_.rest()).sum();
      result_.outcome.newton_steps += state.newton_steps;
      result_.outcome.cg_iterations += state.cg_iterations;
    }
    const Index good = first_not_growing(depth) - 1;
    if (good < L) {
      result_.outcome.reached_press = false;
      result_.outcome.shortfall = good < solved
                                      ? "its patch does not give way further as the load grows"
                                      : path.why_stopped;
      // The last good level becomes the full load; if not even the first is good, a part of it.
      result_.full_load *= good > 0 ? kBackOff * static_cast<double>(good) / L : 0.5 / L;
      return false;
    }
    result_.press_depth = depth;
    result_.outcome.press = depth[L];
    states_ = std::move(path.steps);
    return true;
  }

  void compute_stress() {
    const StageTimer timer(times_, "stress");
    const Index N = unit_load_.cols(), L = settings_.levels;
    result_.displacement.resize(3 * N, L);
    result_.stress.resize(6 * N, L);
    for (Index l = 0; l < L; ++l) {
      const Equilibrium& state = states_[static_cast<std::size_t>(l)];
      const StressField stress = solver_.added_stress(state.displacement);
      const StressField skin = stress(Eigen::all, solver_.boundary().node_of_vertex);
      result_.largest_von_mises = std::max(result_.largest_von_mises, von_mises(skin).maxCoeff());
      result_.outcome.smallest_volume_ratio =
          std::min(result_.outcome.smallest_volume_ratio, state.smallest_volume_ratio);
      result_.stress.col(l) = stress.reshaped().cast<float>();
      result_.displacement.col(l) = (state.displacement - solver_.rest()).reshaped().cast<float>();
    }
  }

  const SiteSolver& solver_;
  const SiteRunSettings& settings_;
  StageTimes& times_;
  Matrix3Xd unit_load_;  // 1 N in total
  std::vector<Equilibrium> states_;
  SiteSnapshots result_;
};

}  // namespace

SiteSolver::SiteSolver(const EquilibriumSolver& solver, const Boundary& boundary,
                       const Matrix3Xd& preload)
    : presses_(solver, preload), boundary_(boundary), recovery_(solver.model().mesh) {
  if (!presses_.is_preloaded()) return;
  rest_stress_ = nodal_cauchy_stress(solver.model(), presses_.rest(), recovery_);
}

StressField SiteSolver::added_stress(const Matrix3Xd& u) const {
  StressField whole = nodal_cauchy_stress(presses_.solver().model(), u, recovery_);
  if (rest_stress_.cols() > 0) whole -= rest_stress_;
  return whole;
}

std::vector<int> site_batches(int site_count) {
  std::vector<int> first;
  for (int s = 0; s < site_count; s += kBatch) first.push_back(s);
  first.push_back(site_count);
  return first;
}

std::vector<SiteSnapshots> solve_sites(const SiteSolver& solver, std::span<const Site> sites,
                                       int first, const SiteRunSettings& settings,
                                       StageTimes& times, const std::function<void(double)>& tick) {
  PALPABLE_EXPECT(!sites.empty(), "a batch has sites");
  PALPABLE_EXPECT((settings.press > 0.0 || settings.force > 0.0) && settings.levels >= 2,
                  "a press or a force, and at least two levels");
  std::vector<SiteSnapshots> results;
  double done = 0;
  const auto step = [&](double part) {
    done += part / static_cast<double>(sites.size());
    if (tick) tick(std::min(done, 1.0));
  };
  for (std::size_t s = 0; s < sites.size(); ++s) {
    try {
      SiteRun run(solver, sites[s], settings, times);
      run.find_load();
      // A search takes about as long as the path after it.
      step(0.5);
      results.push_back(run.solve());
      step(0.5);
    } catch (const Error& error) {
      throw Error(fmt::format("site {}: {}", first + static_cast<int>(s), error.what()));
    }
  }
  return results;
}

}  // namespace palpable
