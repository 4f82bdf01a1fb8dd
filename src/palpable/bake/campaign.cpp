#include "palpable/bake/campaign.h"

#include "palpable/bake/calculix_sites.h"
#include "palpable/base/contract.h"
#include "palpable/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;

void add(Digest& digest, const Material& material) {
  digest.add(law_name(material));
  std::visit([&](const auto& law) { digest.add(&law, sizeof law); }, material);
}

void add(Digest& digest, const std::vector<int>& list) {
  digest.add(static_cast<int>(list.size()));
  digest.add(list.data(), list.size() * sizeof(int));
}

// What all points share.
Digest digest_of_problem(const CampaignPlan& plan) {
  Digest digest;
  digest.add(kSnapshotLayout);
  digest.add(kSiteRunRevision);
  digest.add(plan.solver);
  const SolidModel& model = plan.model;
  digest.add(model.mesh.nodes);
  digest.add(model.mesh.tets);
  digest.add(model.mesh.edge_nodes);
  for (const HeldComponent& held : held_components(model)) {
    digest.add(static_cast<int>(held.at));
    digest.add(held.displacement);
  }
  for (const MaterialGroup& group : model.groups) add(digest, group.elements);
  digest.add(plan.preload);
  digest.add(plan.run.press);
  digest.add(plan.run.force);
  digest.add(plan.run.levels);
  return digest;
}

SolidModel model_at(const CampaignPlan& plan, int point) {
  const PointMaterials& materials = plan.points[static_cast<std::size_t>(point)];
  SolidModel model = plan.model;
  model.material = materials.material;
  PALPABLE_EXPECT(materials.groups.size() == model.groups.size(), "a material for each group");
  for (std::size_t g = 0; g < model.groups.size(); ++g) {
    model.groups[g].material = materials.groups[g];
  }
  return model;
}

// A press that no site reaches is a wrong wish and not a property of the body.
void refuse_if_out_of_reach(const SnapshotStore& store, int point, double press) {
  const int S = store.content().site_count();
  std::optional<SiteOutcome> farthest;
  for (int s = 0; s < S; ++s) {
    SiteOutcome outcome = store.unit(point * S + s).outcome;
    if (outcome.reached_press) return;
    if (!farthest || outcome.press > farthest->press) farthest = std::move(outcome);
  }
  throw Error(fmt::format(
      "no load presses any of the {} sites in by {:.3g} m: the farthest gets to {:.3g} m, then {}; "
      "ask for a smaller press",
      S, press, farthest->press, farthest->shortfall));
}

// Counts sites for the bar, those of earlier runs included.
class Account {
 public:
  Account(const Progress& progress, int there, int total)
      : progress_(progress), done_(there), total_(total) {
    if (there > 0) found_ = fmt::format("{} were there", there);
  }
  // A part of a batch that is being solved here, in sites.
  void part(int batch, double sites) {
    const std::lock_guard lock(mutex_);
    if (static_cast<std::size_t>(batch) >= parts_.size()) {
      parts_.resize(static_cast<std::size_t>(batch) + 1, 0.0);
    }
    parts_[static_cast<std::size_t>(batch)] = sites;
    tell();
  }
  void finished(int batch, int sites, int fell_short) {
    const std::lock_guard lock(mutex_);
    if (static_cast<std::size_t>(batch) < parts_.size()) {
      parts_[static_cast<std::size_t>(batch)] = 0.0;
    }
    done_ += sites;
    short_ += fell_short;
    tell();
  }
  void begin() {
    const std::lock_guard lock(mutex_);
    tell();
  }
  void next_point() {
    const std::lock_guard lock(mutex_);
    parts_.clear();
  }

 private:
  void tell() {
    std::string note = found_;
    if (short_ > 0) {
      note += fmt::format("{}{} short of the press", note.empty() ? "" : ", ", short_);
    }
    const double parts = std::accumulate(parts_.begin(), parts_.end(), 0.0);
    report(progress_, {"solving sites", std::min(done_ + parts, total_), total_, note});
  }

  const Progress& progress_;
  std::mutex mutex_;
  double done_, total_;
  int short_ = 0;
  std::string found_;
  std::vector<double> parts_;
};

}  // namespace

std::vector<std::uint64_t> unit_keys(const CampaignPlan& plan) {
  const int S = static_cast<int>(plan.sites.size());
  const std::vector<int> batches = site_batches(S);
  const Digest problem = digest_of_problem(plan);
  std::vector<std::uint64_t> keys;
  for (const PointMaterials& point : plan.points) {
    Digest at_point = problem;
    add(at_point, point.material);
    for (const Material& group : point.groups) add(at_point, group);
    for (std::size_t b = 0; b + 1 < batches.size(); ++b) {
      Digest batch = at_point;
      for (int s = batches[b]; s < batches[b + 1]; ++s) {
        const Site& site = plan.sites[static_cast<std::size_t>(s)];
        add(batch, site.patch);
        batch.add(site.weights.data(), site.weights.size() * sizeof(float));
        batch.add(site.direction);
      }
      for (int s = batches[b]; s < batches[b + 1]; ++s) {
        Digest unit = batch;
        unit.add(s - batches[b]);
        keys.push_back(unit.value());
      }
    }
  }
  return keys;
}

CampaignReport run_campaign(const CampaignPlan& plan, const SnapshotStore& store, Crew& crew,
                            const CampaignSettings& settings, const Progress& progress) {
  const int S = static_cast<int>(plan.sites.size()), P = static_cast<int>(plan.points.size());
  PALPABLE_EXPECT(S > 0 && P > 0, "a campaign has sites and points");
  PALPABLE_EXPECT(store.content().unit_count() == S * P, "the store is of this plan");
  const std::vector<int> batches = site_batches(S);
  const int B = static_cast<int>(batches.size()) - 1;
  const int threads = crew.threads(settings.threads);
  const auto of_shard = [&](int p, int b) {
    return (p * B + b) % settings.shards == settings.shard;
  };

  CampaignReport result;
  std::vector<char> there(static_cast<std::size_t>(P * S), 0);
  std::vector<int> pending;  // p B + b
  int total = 0;
  if (crew.leads()) {
    for (int p = 0; p < P; ++p) {
      for (int b = 0; b < B; ++b) {
        const int first = batches[static_cast<std::size_t>(b)];
        const int end = batches[static_cast<std::size_t>(b) + 1];
        if (!of_shard(p, b)) {
          result.missing += end - first;
          continue;
        }
        total += end - first;
        bool complete = true;
        for (int s = first; s < end; ++s) {
          const bool has = store.has(p * S + s);
          there[static_cast<std::size_t>(p * S + s)] = has;
          result.reused += has;
          complete &= has;
        }
        if (!complete) pending.push_back(p * B + b);
        report(progress, {"looking for snapshots", static_cast<double>(p * S + end),
                          static_cast<double>(P * S), ""});
      }
    }
  }
  pending = crew.agree(std::move(pending));

  Account account(progress, result.reused, total);
  std::mutex timing;
  for (int p = 0; p < P; ++p) {
    std::vector<int> here;
    for (const int at : pending) {
      if (at / B == p) here.push_back(at % B);
    }
    if (here.empty()) continue;
    account.begin();
    account.next_point();
    const EquilibriumSolver solver(model_at(plan, p));
    const SiteSolver presses(solver, plan.boundary, plan.preload);
    std::optional<CalculixSites> calculix;
    if (plan.solver == "calculix") calculix.emplace(presses, settings.calculix);
    // The number of the batch's sites that fall short of the press.
    const auto work = [&](int i) {
      const int b = here[static_cast<std::size_t>(i)];
      const int first = batches[static_cast<std::size_t>(b)];
      const int count = batches[static_cast<std::size_t>(b) + 1] - first;
      const std::span<const Site> sites(&plan.sites[static_cast<std::size_t>(first)],
                                        static_cast<std::size_t>(count));
      StageTimes spent;
      const auto tick = [&](double done) { account.part(i, done * count); };
      const std::vector<SiteSnapshots> solved =
          calculix ? calculix->solve(sites, first, plan.run, spent, tick)
                   : solve_sites(presses, sites, first, plan.run, spent, tick);
      int fell_short = 0;
      {
        const StageTimer timer(spent, "write");
        for (int k = 0; k < count; ++k) {
          const SiteSnapshots& site = solved[static_cast<std::size_t>(k)];
          store.write(p * S + first + k, site, presses.rest());
          fell_short += !site.outcome.reached_press;
        }
      }
      const std::lock_guard lock(timing);
      result.times.add(spent);
      return fell_short;
    };
    const auto finished = [&](int i, int fell_short) {
      const auto b = static_cast<std::size_t>(here[static_cast<std::size_t>(i)]);
      int count = 0;
      for (int s = batches[b]; s < batches[b + 1]; ++s) {
        count += !there[static_cast<std::size_t>(p * S + s)];
      }
      result.solved += count;
      account.finished(i, count, fell_short);
    };
    crew.share(static_cast<int>(here.size()), threads, work, finished);
  }
  if (!crew.leads() || result.missing > 0) return result;
  if (plan.run.force == 0.0) {
    for (int p = 0; p < P; ++p) refuse_if_out_of_reach(store, p, plan.run.press);
  }
  store.finish();
  return result;
}

}  // namespace palpable
