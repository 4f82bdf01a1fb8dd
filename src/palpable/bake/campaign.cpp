#include "palpable/bake/campaign.h"

#include "palpable/bake/body_problem.h"
#include "palpable/bake/press_solver.h"
#include "palpable/base/contract.h"
#include "palpable/base/error.h"
#include "palpable/solid/stress.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
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

// What one site adds to the campaign.
struct SiteResult {
  double full_load = 0;
  SiteOutcome outcome;
  std::vector<Matrix3Xd> displacement;  // (L)
  std::vector<StressField> stress;      // (L)
  VectorXd press_depth;                 // (L + 1)
  double largest_von_mises = 0;
  StageTimes times;
};

// Index of the first level whose press depth does not exceed the one before; L + 1 if there is
// none.
Index first_not_growing(const VectorXd& depth) {
  Index l = 1;
  while (l < depth.size() && depth[l] > depth[l - 1]) ++l;
  return l;
}

// Stress recovery, and what it recovers from the body that nobody presses.
struct RestStress {
  explicit RestStress(const PressSolver& solver)
      : model(solver.solver().model()), recovery(model.mesh) {
    if (solver.is_preloaded()) stress = nodal_cauchy_stress(model, solver.rest(), recovery);
  }

  // What the press adds in the state u.
  [[nodiscard]] StressField added(const Matrix3Xd& u) const {
    StressField whole = nodal_cauchy_stress(model, u, recovery);
    if (stress.cols() > 0) whole -= stress;
    return whole;
  }

  const SolidModel& model;
  StressRecovery recovery;
  StressField stress;  // no columns: none
};

class SiteRun {
 public:
  SiteRun(const PressSolver& solver, const RestStress& at_rest, const Boundary& boundary,
          const Site& site, const CampaignSettings& settings)
      : solver_(solver), at_rest_(at_rest), boundary_(boundary), settings_(settings) {
    unit_load_ = unit_load(site, boundary, solver.solver().model().mesh.node_count());
  }

  // The load to which this site will be pressed.
  void find_load() {
    if (settings_.force > 0.0) {
      result_.full_load = settings_.force;
      return;
    }
    const StageTimer timer(result_.times, "load search");
    const LoadSearch search = solver_.find_load(unit_load_, settings_.press);
    result_.full_load = search.load;
    result_.outcome.reached_press = search.reached;
    result_.outcome.press = search.press;
    if (!search.reached) {
      result_.full_load *= kBackOff;
      result_.outcome.shortfall = search.why_stopped;
    }
  }

  // States and stresses at all levels; lowers the load where the path does not go through.
  void solve() {
    const double wanted = result_.full_load;
    for (int lowering = 0; lowering < kMaxLowerings; ++lowering) {
      if (!(result_.full_load > 0.0)) break;
      if (try_path()) {
        compute_stress();
        return;
      }
    }
    throw Error(fmt::format("cannot be pressed with a load between 0 and {:.3g} N: {}", wanted,
                            result_.outcome.shortfall));
  }

  // After find_load().
  [[nodiscard]] bool reached() const { return result_.outcome.reached_press; }
  [[nodiscard]] double press() const { return result_.outcome.press; }
  [[nodiscard]] const std::string& shortfall() const { return result_.outcome.shortfall; }

  SiteResult take() { return std::move(result_); }

 private:
  bool try_path() {
    const StageTimer timer(result_.times, "solve");
    const int L = settings_.levels;
    std::vector<double> levels;
    for (int l = 1; l <= L; ++l) levels.push_back(static_cast<double>(l) / L);
    const Matrix3Xd full = result_.full_load * unit_load_;
    PathResult path = solver_.solve_path(full, levels);
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
    for (Equilibrium& state : path.steps) {
      result_.outcome.smallest_volume_ratio =
          std::min(result_.outcome.smallest_volume_ratio, state.smallest_volume_ratio);
      // From the unloaded body, until the stress has been computed from it.
      result_.displacement.push_back(std::move(state.displacement));
    }
    return true;
  }

  void compute_stress() {
    const StageTimer timer(result_.times, "stress");
    for (Matrix3Xd& u : result_.displacement) {
      result_.stress.push_back(at_rest_.added(u));
      const StressField skin = result_.stress.back()(Eigen::all, boundary_.node_of_vertex);
      result_.largest_von_mises = std::max(result_.largest_von_mises, von_mises(skin).maxCoeff());
      u -= solver_.rest();
    }
  }

  const PressSolver& solver_;
  const RestStress& at_rest_;
  const Boundary& boundary_;
  const CampaignSettings& settings_;
  Matrix3Xd unit_load_;  // 1 N in total
  SiteResult result_;
};

// Runs work(s) for s = 0 .. count - 1 on some threads. The first exception (lowest s) is thrown
// after all have ended; later items are then left out.
template <class Work>
void in_parallel(int count, int threads, const Work& work) {
  std::atomic<int> next{0};
  std::atomic<bool> failed{false};
  std::vector<std::exception_ptr> problems(static_cast<std::size_t>(count));
  const auto run = [&] {
    for (int s = next++; s < count && !failed; s = next++) {
      try {
        work(s);
      } catch (...) {
        problems[static_cast<std::size_t>(s)] = std::current_exception();
        failed = true;
      }
    }
  };
  std::vector<std::thread> others;
  for (int t = 1; t < std::min(threads, count); ++t) others.emplace_back(run);
  run();
  for (std::thread& thread : others) thread.join();
  for (const std::exception_ptr& problem : problems) {
    if (problem) std::rethrow_exception(problem);
  }
}

int thread_count(int wanted) {
  if (wanted > 0) return wanted;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

Campaign assemble(std::vector<Site> sites, std::vector<SiteResult> results, int levels,
                  Index node_count) {
  const auto S = static_cast<Index>(sites.size());
  const Index L = levels;
  Campaign campaign;
  campaign.levels = VectorXd::LinSpaced(L + 1, 0.0, 1.0);
  campaign.press_depth.resize(L + 1, S);
  campaign.displacement = {Eigen::MatrixXd(3 * node_count, S * L), {static_cast<int>(S), levels}};
  campaign.stress = {Eigen::MatrixXd(6 * node_count, S * L), {static_cast<int>(S), levels}};
  for (Index s = 0; s < S; ++s) {
    SiteResult& result = results[static_cast<std::size_t>(s)];
    sites[static_cast<std::size_t>(s)].full_load = result.full_load;
    campaign.press_depth.col(s) = result.press_depth;
    for (Index l = 0; l < L; ++l) {
      const auto at = static_cast<std::size_t>(l);
      campaign.displacement.values.col(s * L + l) = result.displacement[at].reshaped();
      campaign.stress.values.col(s * L + l) = result.stress[at].reshaped();
    }
    campaign.largest_von_mises = std::max(campaign.largest_von_mises, result.largest_von_mises);
    campaign.times.add(result.times);
    campaign.outcomes.push_back(std::move(result.outcome));
    result.displacement.clear();
    result.stress.clear();
  }
  campaign.sites = std::move(sites);
  return campaign;
}

// A press that no site reaches is a wrong wish and not a property of the body.
void refuse_if_out_of_reach(const std::vector<std::optional<SiteRun>>& runs, double press) {
  const SiteRun* farthest = nullptr;
  for (const std::optional<SiteRun>& run : runs) {
    if (run->reached()) return;
    if (farthest == nullptr || run->press() > farthest->press()) farthest = &*run;
  }
  throw Error(fmt::format(
      "no load presses any of the {} sites in by {:.3g} m: the farthest gets to {:.3g} m, then {}; "
      "ask for a smaller press",
      runs.size(), press, farthest->press(), farthest->shortfall()));
}

}  // namespace

Campaign run_campaign(const EquilibriumSolver& solver, const Boundary& boundary,
                      std::vector<Site> sites, const CampaignSettings& settings,
                      const Progress& progress) {
  PALPABLE_EXPECT(!sites.empty(), "a campaign has sites");
  PALPABLE_EXPECT((settings.press > 0.0 || settings.force > 0.0) && settings.levels >= 2,
                  "a press or a force, and at least two levels");
  const int S = static_cast<int>(sites.size());
  const int threads = thread_count(settings.threads);

  std::mutex reporting;
  int done = 0, short_of_press = 0;
  const auto tell = [&](const char* task, bool fell_short) {
    const std::lock_guard lock(reporting);
    ++done;
    short_of_press += fell_short;
    report(progress,
           {task, static_cast<double>(done), static_cast<double>(S),
            short_of_press > 0 ? fmt::format("{} short of the press", short_of_press) : ""});
  };

  const PressSolver presses(solver, settings.preload);
  const RestStress at_rest(presses);
  std::vector<std::optional<SiteRun>> runs(sites.size());
  report(progress, {"finding loads", 0.0, static_cast<double>(S), ""});
  in_parallel(S, threads, [&](int s) {
    const auto at = static_cast<std::size_t>(s);
    try {
      runs[at].emplace(presses, at_rest, boundary, sites[at], settings).find_load();
    } catch (const Error& error) { throw Error(fmt::format("site {}: {}", s, error.what())); }
    tell("finding loads", false);
  });

  refuse_if_out_of_reach(runs, settings.press);

  done = 0;
  report(progress, {"solving sites", 0.0, static_cast<double>(S), ""});
  std::vector<SiteResult> results(sites.size());
  in_parallel(S, threads, [&](int s) {
    const auto at = static_cast<std::size_t>(s);
    try {
      runs[at]->solve();
    } catch (const Error& error) { throw Error(fmt::format("site {}: {}", s, error.what())); }
    results[at] = runs[at]->take();
    tell("solving sites", !results[at].outcome.reached_press);
  });
  Campaign campaign = assemble(std::move(sites), std::move(results), settings.levels,
                               solver.model().mesh.node_count());
  campaign.rest = presses.rest();
  return campaign;
}

}  // namespace palpable
