#include "palpable/bake/campaign/site_run.h"

#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/solid/lockstep.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::VectorXd;

// The solved path of one site as snapshots.
SiteSnapshots snapshots_of(const SiteSolver& solver, const PressPath& path) {
  const auto L = static_cast<Index>(path.steps.size());
  const Index N = solver.rest().cols();
  SiteSnapshots site;
  site.full_load = path.full_load;
  site.press_depth = path.press;
  site.outcome.reached_press = path.reached;
  site.outcome.press = path.press[L];
  site.outcome.shortfall = path.why_stopped;
  site.outcome.newton_steps = path.newton_steps;
  site.outcome.cg_iterations = path.cg_iterations;
  site.displacement.resize(3 * N, L);
  site.stress.resize(6 * N, L);
  for (Index l = 0; l < L; ++l) {
    const Equilibrium& state = path.steps[l];
    const StressField stress = solver.added_stress(state.displacement);
    const StressField skin = stress(Eigen::all, solver.boundary().node_of_vertex);
    site.largest_von_mises = std::max(site.largest_von_mises, von_mises(skin).maxCoeff());
    site.outcome.smallest_volume_ratio =
        std::min(site.outcome.smallest_volume_ratio, state.smallest_volume_ratio);
    site.stress.col(l) = stress.reshaped().cast<float>();
    site.displacement.col(l) = (state.displacement - solver.rest()).reshaped().cast<float>();
  }
  return site;
}

// As press_path(), for a known load.
PressPath path_through(const PressSolver& presses, const Matrix3Xd& unit, double full_load,
                       std::span<const double> levels, Lane& lane) {
  PathResult solved = presses.solve_path(full_load * unit, levels, &lane);
  PressPath path{.full_load = full_load,
                 .steps = std::move(solved.steps),
                 .press = {},
                 .reached = solved.complete,
                 .stop = solved.stop,
                 .why_stopped = std::move(solved.why_stopped),
                 .factors = solved.factors,
                 .halvings = solved.halvings,
                 .times = solved.times};
  path.press = VectorXd::Zero(static_cast<Index>(path.steps.size()) + 1);
  for (std::size_t l = 0; l < path.steps.size(); ++l) {
    const Equilibrium& step = path.steps[l];
    path.press[static_cast<Index>(l) + 1] =
        unit.cwiseProduct(step.displacement - presses.rest()).sum();
    path.newton_steps += step.newton_steps;
    path.cg_iterations += step.cg_iterations;
  }
  return path;
}

// Number of sites in progress. With 16 and some more per thread, a thread's pass through the factor
// is full while the other lanes do the rest of their work. Fewer where they would take more than
// kMemory together.
int lanes_for(const SiteSolver& solver, int levels, int threads) {
  constexpr double kMemory = 2e9;  // bytes
  const double a_lane =
      solver.presses().solver().model().mesh.node_count() * (24.0 * levels + kBytesPerNodeOfCall);
  return std::clamp(static_cast<int>(kMemory / a_lane), threads, 20 * threads);
}

}  // namespace

SiteSolver::SiteSolver(const EquilibriumSolver& solver, const Boundary& boundary,
                       const Matrix3Xd& preload, double range)
    : presses_(solver, preload, range), boundary_(boundary), recovery_(solver.model().mesh) {
  if (!presses_.is_preloaded()) return;
  rest_stress_ = nodal_cauchy_stress(solver.model(), presses_.rest(), recovery_);
}

StressField SiteSolver::added_stress(const Matrix3Xd& u) const {
  StressField whole = nodal_cauchy_stress(presses_.solver().model(), u, recovery_);
  if (rest_stress_.cols() > 0) whole -= rest_stress_;
  return whole;
}

void solve_sites(const SiteSolver& solver, std::span<const Site> sites,
                 const SiteRunSettings& settings, int threads, const SiteStream& stream) {
  PALPABLE_EXPECT(!settings.at.empty() ||
                      ((settings.press > 0.0 || settings.force > 0.0) && settings.levels >= 2),
                  "a press or a force, and at least two levels");
  PALPABLE_EXPECT(settings.full_loads.size() == (settings.at.empty() ? 0 : sites.size()),
                  "a load of each site, where levels are given");
  const PressGoal goal{.press = settings.press, .force = settings.force, .levels = settings.levels};
  const auto work = [&](int s, Lane& lane) {
    const Site& site = sites[s];
    StageTimes times;
    std::optional<StageTimer> timer(std::in_place, times, "solve");
    const Matrix3Xd unit =
        unit_load(site, solver.boundary(), solver.presses().solver().model().mesh.node_count());
    const PressPath path =
        settings.at.empty()
            ? solver.presses().press_path(unit, goal, &lane,
                                          [&](double part) { stream.tick(s, 0.95 * part); })
            : path_through(solver.presses(), unit, settings.full_loads[s], settings.at, lane);
    if (path.steps.empty()) {
      const Eigen::Vector3d X = solver.boundary().surface.vertices.col(site.vertex);
      throw Error(fmt::format("site {} at ({:.4g}, {:.4g}, {:.4g}) m cannot be pressed: {}", s,
                              X[0], X[1], X[2], path.why_stopped));
    }
    if (!settings.at.empty() && !path.reached) {
      throw Error(fmt::format("site {}: no equilibrium under a load that the campaign reached: {}",
                              s, path.why_stopped));
    }
    timer.emplace(times, "stress");
    SiteSnapshots snapshots = snapshots_of(solver, path);
    timer.reset();
    stream.finished(s, std::move(snapshots), times);
  };
  run_in_lockstep(stream.next, work,
                  {.threads = threads, .lanes = lanes_for(solver, settings.levels, threads)});
}

void solve_linear(const SiteSolver& solver, std::span<const Site> sites, int count, int threads,
                  const LinearStream& stream) {
  const SolidModel& model = solver.presses().solver().model();
  const Boundary& boundary = solver.boundary();
  const auto work = [&](int first, Lane& lane) {
    const int end = std::min(first + count, static_cast<int>(sites.size()));
    Eigen::MatrixXf responses(3 * boundary.surface.vertices.cols(), end - first);
    for (int s = first; s < end; ++s) {
      const Matrix3Xd unit = unit_load(sites[s], boundary, model.mesh.node_count());
      Matrix3Xd u;
      try {
        u = solver.presses().linear_response(unit, &lane);
      } catch (const Error& e) {
        throw Error(fmt::format("vertex {}: {}", sites[s].vertex, e.what()));
      }
      responses.col(s - first) = u(Eigen::all, boundary.node_of_vertex).reshaped().cast<float>();
    }
    stream.finished(first, std::move(responses));
  };
  run_in_lockstep(stream.next, work, {.threads = threads, .lanes = lanes_for(solver, 1, threads)});
}

}  // namespace palpable
