#include "palpable/bake/campaign/campaign.h"

#include "palpable/bake/campaign/calculix_sites.h"
#include "palpable/bake/campaign/press_solver.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;

void add(Digest& digest, const Material& material) {
  digest.add(law_name(material));
  std::visit([&](const auto& law) { digest.add(&law, sizeof law); }, material);
}

void add(Digest& digest, const Site& site) {
  digest.add(site.patch);
  digest.add(site.weights.data(), site.weights.size() * sizeof(float));
  digest.add(site.direction);
}

// Digest of the inputs that all points share.
Digest digest_of_problem(const CampaignPlan& plan) {
  Digest digest;
  digest.add(kSnapshotLayout);
  digest.add(kSiteRunRevision);
  digest.add(std::string(fe_solver_name(plan.solver)));
  const SolidModel& model = plan.model;
  digest.add(model.mesh.nodes);
  digest.add(model.mesh.tets);
  digest.add(model.mesh.edge_nodes);
  for (const HeldComponent& held : held_components(model)) {
    digest.add(static_cast<int>(held.at));
    digest.add(held.displacement);
  }
  for (const MaterialGroup& group : model.groups) digest.add(group.elements);
  digest.add(plan.preload);
  digest.add(plan.run.press);
  digest.add(plan.run.force);
  digest.add(plan.run.levels);
  for (const double level : plan.run.at) digest.add(level);
  for (const double load : plan.full_loads) digest.add(load);
  if (std::isfinite(model.largest_displacement)) digest.add(model.largest_displacement);
  if (plan.run.range > 0.0) digest.add(plan.run.range);
  return digest;
}

SolidModel model_at(const CampaignPlan& plan, int point) {
  const PointMaterials& materials = plan.points[point];
  SolidModel model = plan.model;
  model.material = materials.material;
  PALPABLE_EXPECT(materials.groups.size() == model.groups.size(), "a material for each group");
  for (std::size_t g = 0; g < model.groups.size(); ++g) {
    model.groups[g].material = materials.groups[g];
  }
  return model;
}

// A press that no site reaches is an error of the description, not a property of the body. So is a
// force that none bears.
void refuse_if_out_of_reach(const SnapshotStore& store, const PointMaterials& materials, int point,
                            const SiteRunSettings& run) {
  const int S = store.content().site_count();
  std::optional<StoredUnit> farthest;
  for (int s = 0; s < S; ++s) {
    StoredUnit unit = store.unit(point * S + s);
    if (unit.outcome.reached_press) return;
    const bool farther =
        !farthest || (run.force > 0.0 ? unit.full_load > farthest->full_load
                                      : unit.outcome.press > farthest->outcome.press);
    if (farther) farthest = std::move(unit);
  }
  const std::string& why = farthest->outcome.shortfall;
  if (run.force > 0.0) {
    throw Error(fmt::format(
        "none of the {} sites bears the force of {:.4g} N ('force' in [press]): the one that bears "
        "most gets to {:.3g} N, then {}. Young's modulus is {}",
        S, run.force, farthest->full_load, why,
        stiffness_text(young_poisson(materials.material).young)));
  }
  throw Error(fmt::format(
      "no load presses any of the {} sites in by {:.3g} m: the farthest gets to {:.3g} m, then {}; "
      "ask for a smaller press",
      S, run.press, farthest->outcome.press, why));
}

// Solves the linear responses that the store lacks, file by file.
// @param solver  that of the sites, if any were solved here: its factor is used again
void solve_linear_responses(const CampaignPlan& plan, const SnapshotStore& store, Crew& crew,
                            const CampaignSettings& settings, const Progress& progress,
                            std::optional<EquilibriumSolver>& solver, CampaignReport& result) {
  const int files = store.content().linear_file_count();
  std::vector<int> pending;
  int there = 0;
  if (crew.leads()) {
    for (int k = 0; k < files; ++k) {
      if (k % settings.shards != settings.shard) {
        ++result.missing;
      } else if (store.has_linear(k)) {
        ++there;
      } else {
        pending.push_back(k);
      }
    }
  }
  pending = crew.agree(std::move(pending));
  if (pending.empty()) return;
  const double total = there + static_cast<double>(pending.size());
  report(progress, {"linear responses", static_cast<double>(there), total, ""});
  // The residual of a linear response is relative to its load, so a load of 1 N needs no tighter
  // tolerance than a press.
  if (!solver) {
    solver.emplace(model_at(plan, 0), EquilibriumSettings{.tolerance = kSnapshotTolerance});
  }
  const SiteSolver presses(*solver, plan.boundary, plan.preload);
  crew.share(
      static_cast<int>(pending.size()),
      [&](const Pieces& pieces) {
        solve_linear(presses, plan.linear, kLinearRow, crew.threads(settings.threads),
                     {[&]() -> std::optional<int> {
                        const std::optional<int> i = pieces.next();
                        if (!i) return std::nullopt;
                        return kLinearRow * pending[*i];
                      },
                      [&](int first, const Eigen::MatrixXf& u) {
                        store.write_linear(first / kLinearRow, u);
                        pieces.finished(first / kLinearRow, 0);
                      }});
      },
      [&](int, int) {
        ++result.linear_solved;
        report(progress,
               {"linear responses", there + static_cast<double>(result.linear_solved), total, ""});
      });
}

// Counts sites for the progress bar, including those of earlier runs.
class Account {
 public:
  Account(const Progress& progress, int there, int total, int units)
      : progress_(progress), done_(there), total_(total), parts_(units, 0.0) {
    if (there > 0) found_ = fmt::format("{} were there", there);
  }
  void begin() {
    const std::lock_guard lock(mutex_);
    show();
  }
  // Sets which part (0 .. 1) of a unit in progress is done.
  void part(int unit, double part) {
    const std::lock_guard lock(mutex_);
    parts_[unit] = part;
    show();
  }
  void finished(int unit, int fell_short) {
    const std::lock_guard lock(mutex_);
    parts_[unit] = 0.0;
    done_ += 1.0;
    short_ += fell_short;
    show();
  }

 private:
  void show() {
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

std::string_view fe_solver_name(FeSolver solver) {
  return solver == FeSolver::kCalculix ? "calculix" : "own";
}

std::uint64_t linear_key(const CampaignPlan& plan) {
  CampaignPlan pressed_by_nothing = plan;
  pressed_by_nothing.run = {};
  pressed_by_nothing.solver = FeSolver::kOwn;
  pressed_by_nothing.model.largest_displacement = std::numeric_limits<double>::infinity();
  Digest digest = digest_of_problem(pressed_by_nothing);
  add(digest, plan.points[0].material);
  for (const Material& group : plan.points[0].groups) add(digest, group);
  for (const Site& site : plan.linear) add(digest, site);
  return digest.value();
}

std::vector<std::uint64_t> unit_keys(const CampaignPlan& plan) {
  const Digest problem = digest_of_problem(plan);
  std::vector<std::uint64_t> keys;
  for (const PointMaterials& point : plan.points) {
    Digest at_point = problem;
    add(at_point, point.material);
    for (const Material& group : point.groups) add(at_point, group);
    for (const Site& site : plan.sites) {
      Digest unit = at_point;
      add(unit, site);
      keys.push_back(unit.value());
    }
  }
  return keys;
}

namespace {

// The units of this shard that the store does not hold yet. The leader looks them up; all processes
// of the crew get the same list.
std::vector<int> pending_units(const SnapshotStore& store, Crew& crew,
                               const CampaignSettings& settings, const Progress& progress,
                               CampaignReport& result) {
  const int units = store.content().unit_count();
  std::vector<int> pending;
  for (int u = 0; crew.leads() && u < units; ++u) {
    report(progress, {"looking for snapshots", u + 1.0, static_cast<double>(units), ""});
    if (u % settings.shards != settings.shard) {
      ++result.missing;
    } else if (store.has(u)) {
      ++result.reused;
    } else {
      pending.push_back(u);
    }
  }
  return crew.agree(std::move(pending));
}

// Solves sites of one point and writes each as soon as it is solved.
class PointRun {
 public:
  PointRun(const CampaignPlan& plan, const SnapshotStore& store, const EquilibriumSolver& solver,
           int point, std::vector<int> sites, const CampaignSettings& settings)
      : plan_(plan),
        store_(store),
        presses_(solver, plan.boundary, plan.preload, plan.run.range),
        sites_(std::move(sites)),
        first_unit_(point * static_cast<int>(plan.sites.size())),
        run_(plan.run) {
    if (plan.solver == FeSolver::kCalculix) calculix_.emplace(presses_, settings.calculix);
    if (plan.run.at.empty()) return;
    const auto loads = plan.full_loads.begin() + first_unit_;
    run_.full_loads.assign(loads, loads + static_cast<std::ptrdiff_t>(plan.sites.size()));
  }

  [[nodiscard]] int count() const { return static_cast<int>(sites_.size()); }
  [[nodiscard]] int unit_of(int site) const { return first_unit_ + site; }

  void solve(const Pieces& pieces, int threads, Account& account, StageTimes& times) {
    const SiteStream stream{[&]() -> std::optional<int> {
                              const std::optional<int> i = pieces.next();
                              return i ? std::optional(sites_[*i]) : std::nullopt;
                            },
                            [&](int s, double part) { account.part(unit_of(s), part); },
                            [&](int s, const SiteSnapshots& snapshots, StageTimes spent) {
                              {
                                const StageTimer timer(spent, "write");
                                store_.write(unit_of(s), snapshots, presses_.rest());
                              }
                              {
                                const std::lock_guard lock(timing_);
                                times.add(spent);
                              }
                              pieces.finished(s, snapshots.outcome.reached_press ? 0 : 1);
                            }};
    if (calculix_) {
      calculix_->solve(plan_.sites, plan_.run, threads, stream);
    } else {
      solve_sites(presses_, plan_.sites, run_, threads, stream);
    }
  }

 private:
  const CampaignPlan& plan_;
  const SnapshotStore& store_;
  SiteSolver presses_;
  std::vector<int> sites_;
  int first_unit_;
  SiteRunSettings run_;
  std::optional<CalculixSites> calculix_;
  std::mutex timing_;  // guards the times that solve() adds to
};

}  // namespace

CampaignReport run_campaign(const CampaignPlan& plan, const SnapshotStore& store, Crew& crew,
                            const CampaignSettings& settings, const Progress& progress) {
  const int S = static_cast<int>(plan.sites.size()), P = static_cast<int>(plan.points.size());
  PALPABLE_EXPECT(S > 0 && P > 0, "a campaign has sites and points");
  PALPABLE_EXPECT(store.content().unit_count() == S * P, "the store is of this plan");
  PALPABLE_EXPECT(plan.run.at.empty() || (static_cast<int>(plan.full_loads.size()) == S * P &&
                                          plan.solver == FeSolver::kOwn),
                  "given levels need a load for each unit, and the own solver");
  const int threads = crew.threads(settings.threads);

  CampaignReport result;
  const std::vector<int> pending = pending_units(store, crew, settings, progress, result);
  Account account(progress, result.reused, result.reused + static_cast<int>(pending.size()), S * P);
  std::optional<EquilibriumSolver> solver;
  for (int p = 0; p < P; ++p) {
    std::vector<int> sites;
    for (const int u : pending) {
      if (u / S == p) sites.push_back(u % S);
    }
    if (sites.empty()) continue;
    account.begin();
    solver.reset();  // keep one factor in memory at a time
    solver.emplace(model_at(plan, p), EquilibriumSettings{.tolerance = kSnapshotTolerance});
    result.setup = solver->setup();
    PointRun run(plan, store, *solver, p, std::move(sites), settings);
    crew.share(
        run.count(),
        [&](const Pieces& pieces) { run.solve(pieces, threads, account, result.times); },
        [&](int s, int fell_short) {
          ++result.solved;
          account.finished(run.unit_of(s), fell_short);
        });
  }
  if (!plan.linear.empty()) {
    PALPABLE_EXPECT(P == 1, "linear responses are of one body");
    solve_linear_responses(plan, store, crew, settings, progress, solver, result);
  }
  if (!crew.leads() || result.missing > 0) return result;
  if (plan.run.at.empty()) {
    for (int p = 0; p < P; ++p) refuse_if_out_of_reach(store, plan.points[p], p, plan.run);
  }
  store.finish();
  return result;
}

}  // namespace palpable
