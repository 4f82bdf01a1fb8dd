#include "palpable/bake/campaign.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <numeric>
#include <span>
#include <thread>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

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

Campaign assemble(std::vector<Site> sites, std::vector<SiteSnapshots> results, int levels,
                  Index node_count) {
  const auto S = static_cast<Index>(sites.size());
  const Index L = levels;
  Campaign campaign;
  campaign.levels = VectorXd::LinSpaced(L + 1, 0.0, 1.0);
  campaign.press_depth.resize(L + 1, S);
  campaign.displacement = {Eigen::MatrixXd(3 * node_count, S * L), {static_cast<int>(S), levels}};
  campaign.stress = {Eigen::MatrixXd(6 * node_count, S * L), {static_cast<int>(S), levels}};
  for (Index s = 0; s < S; ++s) {
    SiteSnapshots& result = results[static_cast<std::size_t>(s)];
    sites[static_cast<std::size_t>(s)].full_load = result.full_load;
    campaign.press_depth.col(s) = result.press_depth;
    campaign.displacement.values.middleCols(s * L, L) = result.displacement.cast<double>();
    campaign.stress.values.middleCols(s * L, L) = result.stress.cast<double>();
    campaign.largest_von_mises = std::max(campaign.largest_von_mises, result.largest_von_mises);
    campaign.outcomes.push_back(std::move(result.outcome));
    result = {};
  }
  campaign.sites = std::move(sites);
  return campaign;
}

// A press that no site reaches is a wrong wish and not a property of the body.
void refuse_if_out_of_reach(const std::vector<SiteSnapshots>& results, double press) {
  const SiteOutcome* farthest = nullptr;
  for (const SiteSnapshots& result : results) {
    if (result.outcome.reached_press) return;
    if (farthest == nullptr || result.outcome.press > farthest->press) farthest = &result.outcome;
  }
  throw Error(fmt::format(
      "no load presses any of the {} sites in by {:.3g} m: the farthest gets to {:.3g} m, then {}; "
      "ask for a smaller press",
      results.size(), press, farthest->press, farthest->shortfall));
}

}  // namespace

Campaign run_campaign(const EquilibriumSolver& solver, const Boundary& boundary,
                      std::vector<Site> sites, const CampaignSettings& settings,
                      const Progress& progress) {
  PALPABLE_EXPECT(!sites.empty(), "a campaign has sites");
  const std::vector<int> batches = site_batches(static_cast<int>(sites.size()));
  const int B = static_cast<int>(batches.size()) - 1;

  std::mutex reporting;
  std::vector<double> part(batches.size(), 0.0);  // of each batch that is done, in sites
  int short_of_press = 0;
  const auto tell = [&](int batch, double done) {
    const std::lock_guard lock(reporting);
    part[static_cast<std::size_t>(batch)] = done;
    report(progress,
           {"solving sites", std::accumulate(part.begin(), part.end(), 0.0),
            static_cast<double>(sites.size()),
            short_of_press > 0 ? fmt::format("{} short of the press", short_of_press) : ""});
  };

  const SiteSolver presses(solver, boundary, settings.preload);
  const SiteRunSettings run{
      .press = settings.press, .force = settings.force, .levels = settings.levels};
  report(progress, {"solving sites", 0.0, static_cast<double>(sites.size()), ""});
  std::vector<SiteSnapshots> results(sites.size());
  StageTimes times;
  in_parallel(B, thread_count(settings.threads), [&](int b) {
    const int first = batches[static_cast<std::size_t>(b)];
    const int count = batches[static_cast<std::size_t>(b) + 1] - first;
    const std::span<const Site> batch(&sites[static_cast<std::size_t>(first)],
                                      static_cast<std::size_t>(count));
    StageTimes spent;
    std::vector<SiteSnapshots> solved =
        solve_sites(presses, batch, first, run, spent, [&](double done) { tell(b, done * count); });
    const std::lock_guard lock(reporting);
    times.add(spent);
    for (SiteSnapshots& site : solved) short_of_press += !site.outcome.reached_press;
    std::move(solved.begin(), solved.end(), results.begin() + first);
  });
  refuse_if_out_of_reach(results, settings.press);
  Campaign campaign = assemble(std::move(sites), std::move(results), settings.levels,
                               solver.model().mesh.node_count());
  campaign.rest = presses.rest();
  campaign.times = times;
  return campaign;
}

}  // namespace palpable
