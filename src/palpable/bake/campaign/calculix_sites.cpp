#include "palpable/bake/campaign/calculix_sites.h"

#include "palpable/bake/calculix/calculix.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/solid/displacement_range.h"
#include "palpable/bake/solid/lockstep.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;

// Where the path of a site ends early, its load is lowered to this fraction of the last one that
// was reached.
constexpr double kBackOff = 0.97;
constexpr int kMaxLowerings = 4;  // paths that are tried, the first included

// Ends a path before its first state beyond the model's range, which ccx knows nothing of.
void cut_to_range(const SolidModel& model, double range, CalculixRun& run) {
  const std::vector<HeldComponent> held = held_components(model);
  const auto beyond = std::find_if(run.states.begin(), run.states.end(), [&](const auto& state) {
    return largest_movement(held, state.displacement) > range;
  });
  if (beyond == run.states.end()) return;
  run.states.erase(beyond, run.states.end());
  run.complete = false;
  run.last_level = run.states.empty() ? 0.0 : run.states.back().level;
  run.why_stopped = beyond_range_text(range);
}

}  // namespace

CalculixSites::CalculixSites(const SiteSolver& solver, std::string program)
    : solver_(solver), program_(std::move(program)) {
  if (!find_calculix(program_)) {
    throw Error(
        fmt::format("'{}' is not installed: the solver calculix runs it (Debian: apt-get install "
                    "calculix-ccx); this project's own needs nothing",
                    program_));
  }
  if (solver.presses().is_preloaded()) {
    throw Error(
        "CalculiX presses bodies on which nothing else acts: leave out gravity, "
        "pressures and supports that move");
  }
}

SiteSnapshots CalculixSites::solve_site(const Site& place, const SiteRunSettings& settings,
                                        StageTimes& times,
                                        const std::function<void(double)>& tick) const {
  const SolidModel& model = solver_.presses().solver().model();
  const Index L = settings.levels;
  std::vector<double> levels;
  for (Index l = 1; l <= L; ++l) levels.push_back(static_cast<double>(l) / static_cast<double>(L));
  const Matrix3Xd unit = unit_load(place, solver_.boundary(), model.mesh.node_count());
  SiteSnapshots site;
  site.full_load = settings.force;
  if (!(settings.force > 0.0)) {
    const StageTimer timer(times, "load search");
    const LoadSearch search = solver_.presses().find_load(unit, settings.press);
    site.outcome.reached_press = search.reached;
    site.outcome.shortfall = search.why_stopped;
    site.full_load = search.reached ? search.load : kBackOff * search.load;
  }
  CalculixSettings ccx;
  ccx.program = program_;
  CalculixRun run;
  for (int lowering = 0; lowering < kMaxLowerings && !run.complete; ++lowering) {
    const StageTimer timer(times, "solve");
    run = solve_with_calculix(model, site.full_load * unit, levels, ccx,
                              [&](const ProgressReport& r) { tick(r.done / r.total); });
    site.outcome.newton_steps += run.iterations;
    cut_to_range(model, solver_.presses().range(), run);
    if (run.complete) break;
    site.outcome.reached_press = false;
    site.outcome.shortfall = fmt::format("CalculiX: {}", run.why_stopped);
    site.full_load *= kBackOff * std::max(run.last_level, 0.1);
  }
  if (!run.complete) throw Error(site.outcome.shortfall);
  const StageTimer timer(times, "stress");
  site.displacement.resize(3 * unit.cols(), L);
  site.stress.resize(6 * unit.cols(), L);
  site.press_depth = Eigen::VectorXd::Zero(L + 1);
  for (Index l = 0; l < L; ++l) {
    const Matrix3Xd& u = run.states[l].displacement;
    const StressField stress = solver_.added_stress(u);
    site.displacement.col(l) = u.reshaped().cast<float>();
    site.stress.col(l) = stress.reshaped().cast<float>();
    site.press_depth[l + 1] = unit.cwiseProduct(u).sum();
    const StressField skin = stress(Eigen::all, solver_.boundary().node_of_vertex);
    site.largest_von_mises = std::max(site.largest_von_mises, von_mises(skin).maxCoeff());
    if (!(site.press_depth[l + 1] > site.press_depth[l])) {
      throw Error("its patch does not give way further as the load grows");
    }
  }
  site.outcome.press = site.press_depth[L];
  return site;
}

void CalculixSites::solve(std::span<const Site> sites, const SiteRunSettings& settings, int threads,
                          const SiteStream& stream) const {
  const auto work = [&](int s, Lane&) {
    try {
      StageTimes times;
      SiteSnapshots snapshots =
          solve_site(sites[s], settings, times, [&](double part) { stream.tick(s, part); });
      stream.finished(s, std::move(snapshots), times);
    } catch (const Error& error) { throw Error(fmt::format("site {}: {}", s, error.what())); }
  };
  run_in_lockstep(stream.next, work, {.threads = threads, .lanes = threads});
}

}  // namespace palpable
