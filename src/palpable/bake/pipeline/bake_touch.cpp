#include "palpable/bake/pipeline/bake_touch.h"

#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/describe/touch_mesh.h"
#include "palpable/bake/pipeline/full_body.h"
#include "palpable/bake/touch_bake/held_out_maker.h"
#include "palpable/bake/touch_bake/touch_maker.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

namespace palpable {
namespace {

using Tables = BodyDescription::Touch::Tables;

// Makes one stage after the other, and records in the store which tables are complete.
class Stages {
 public:
  // @param carries  whether `body` is on a coarser mesh that carries the skin
  Stages(const FullBody& body, bool carries, const SnapshotStore& store,
         const std::function<void(const TouchTables&, BodyStage)>& use, const Progress& progress)
      : body_(body),
        carries_(carries),
        store_(store.touch_folder()),
        campaign_(campaign_key(store.content())),
        use_(use),
        progress_(progress) {}
  TouchTables make(const TouchBakeSettings& settings, BodyStage stage) {
    TouchTables tables = make_touch_tables(body_.skin, settings, progress_, &store_);
    keys_ = touch_keys(body_.skin, settings);
    hand_over(tables, stage);
    return tables;
  }

  void hold_out(TouchTables tables, const HeldOutSettings& settings) {
    keys_.held_out = held_out_key(keys_, tables, settings);
    tables.held_out = make_held_out(body_.solver, body_.skin, body_.presses.preloaded(), tables,
                                    settings, progress_, keys_, &store_);
    hand_over(tables, BodyStage::kFinished);
  }

  void end() { store_.remove_leftovers(); }

 private:
  const FullBody& body_;
  bool carries_;
  TouchStore store_;
  std::uint64_t campaign_;
  const std::function<void(const TouchTables&, BodyStage)>& use_;
  const Progress& progress_;
  TouchKeys keys_;

  void hand_over(TouchTables tables, BodyStage stage) {
    if (carries_) tables.coarse = {body_.skin.skin(), body_.skin.fixed()};
    store_.keep_list(campaign_, keys_, tables, std::string(key_of(stage)));
    use_(tables, stage);
  }
};

}  // namespace

TouchBakeSettings touch_settings(const BodyDescription& description, int threads) {
  const BodyDescription::Touch& wanted = description.touch;
  TouchBakeSettings settings;
  settings.threads = threads;
  settings.friction = wanted.friction;
  if (wanted.regions) settings.regions.most = *wanted.regions;
  if (wanted.cross_modes) settings.cross.modes = *wanted.cross_modes;
  if (wanted.clusters) settings.compliance.most = *wanted.clusters;
  if (wanted.cluster_modes) settings.compliance.rank = *wanted.cluster_modes;
  if (wanted.region_modes) settings.regions.modes = *wanted.region_modes;
  if (wanted.leading_modes) settings.regions.leading = *wanted.leading_modes;
  if (description.inertia && wanted.modes > 0) {
    settings.inertia = {.density = description.inertia->density,
                        .loss_factor = description.inertia->loss_factor,
                        .modes = wanted.modes};
  }
  settings.regions.leading = std::min(settings.regions.leading, settings.regions.modes);
  return settings;
}

std::string bake_touch(const BodyDescription& description, const CampaignPlan& plan,
                       const SnapshotStore& store, int threads,
                       const std::function<void(const TouchTables&, BodyStage)>& use,
                       const Progress& progress) {
  const BodyDescription::Touch& wanted = description.touch;
  if (wanted.tables == Tables::kNone) return {};
  PALPABLE_EXPECT(plan.points.size() == 1, "tables of touch are of one body");
  std::optional<BodyProblem> coarse;
  try {
    const SurfaceMesh& skin = plan.boundary.surface;
    if (const auto edge = touch_edge(description, skin)) {
      coarse = pose_coarser(description, skin, *edge);
    }
  } catch (const Error& error) {
    if (!wanted.by_default || wanted.edge) throw;
    return error.what();
  }
  const FullBody body =
      coarse ? FullBody(coarse->model, coarse->mesh.boundary, coarse->preload,
                        {.tolerance = kSnapshotTolerance})
             : FullBody(plan.model, plan.boundary, plan.preload, {.tolerance = kSnapshotTolerance});
  const TouchBakeSettings settings = touch_settings(description, threads);
  TouchBakeSettings linear = settings;
  linear.regions.most = linear.cross.modes = 0;
  Stages stages(body, coarse.has_value(), store, use, progress);
  const bool full = wanted.tables == Tables::kFull;
  const BodyStage with_all = wanted.held_out > 0 ? BodyStage::kTables : BodyStage::kFinished;
  TouchTables tables = stages.make(linear, full ? BodyStage::kLinear : with_all);
  if (full) tables = stages.make(settings, with_all);
  if (wanted.held_out > 0) {
    const double range = body.solver.model().largest_displacement;
    stages.hold_out(std::move(tables),
                    {.count = wanted.held_out,
                     .threads = threads,
                     .own_range = description.press.has_usual_range() ? 0.0 : range});
  }
  stages.end();
  return {};
}

BodyStage kept_touch_stage(const SnapshotStore& store) {
  return stage_of_key(TouchStore(store.touch_folder()).listed_stage(campaign_key(store.content())));
}

std::optional<TouchTables> kept_touch_tables(const SnapshotStore& store) {
  return TouchStore(store.touch_folder()).find_listed(campaign_key(store.content()));
}

}  // namespace palpable
