#include "palpable/bake/bake_touch.h"

#include "palpable/base/contract.h"
#include "palpable/touch/touch_text.h"
#include "palpable/touch_bake/touch_maker.h"

#include <algorithm>

namespace palpable {
namespace {

// The body as it is pressed: the preload has acted.
SkinResponse response_of(const CampaignPlan& plan) {
  const std::vector<HeldComponent> held = held_components(plan.model);
  const bool moved = std::any_of(held.begin(), held.end(),
                                 [](const HeldComponent& h) { return h.displacement != 0.0; });
  if (!moved && plan.preload.cols() == 0) return {plan.model, plan.boundary};
  const EquilibriumSolver solver(plan.model, {.tolerance = kSnapshotTolerance});
  const PressSolver presses(solver, plan.preload);
  return {plan.model, plan.boundary, presses.preloaded()};
}

}  // namespace

void bake_touch(const CampaignPlan& plan, const BodyDescription::Touch& wanted,
                const SnapshotStore& store, int threads,
                const std::function<void(const TouchTables&)>& use, const Progress& progress) {
  using Tables = BodyDescription::Touch::Tables;
  if (wanted.tables == Tables::kNone) return;
  PALPABLE_EXPECT(plan.points.size() == 1, "tables of touch are of one body");
  const SkinResponse skin = response_of(plan);
  const TouchStore kept(store.touch_folder());
  TouchBakeSettings settings;
  settings.threads = threads;
  if (wanted.regions) settings.regions.most = *wanted.regions;
  TouchBakeSettings linear = settings;
  linear.regions.most = linear.cross.modes = 0;
  const auto finish = [&](const TouchBakeSettings& made, const TouchTables& tables) {
    kept.keep_list(campaign_key(store.content()), touch_keys(skin, made), tables);
    use(tables);
  };
  {
    const TouchTables tables = make_touch_tables(skin, linear, progress, &kept);
    finish(linear, tables);
  }
  if (wanted.tables == Tables::kFull) {
    const TouchTables tables = make_touch_tables(skin, settings, progress, &kept);
    finish(settings, tables);
  }
  kept.remove_leftovers();
}

std::optional<TouchTables> kept_touch_tables(const SnapshotStore& store) {
  return TouchStore(store.touch_folder()).find_listed(campaign_key(store.content()));
}

void state_touch(const TouchTables& tables, ReducedBody& body) {
  auto& lines = body.provenance;
  std::erase_if(lines, [](const auto& line) { return line.first == "touch"; });
  const auto program = std::find_if(lines.begin(), lines.end(),
                                    [](const auto& line) { return line.first == "program"; });
  lines.insert(program, {"touch", touch_line(tables)});
}

}  // namespace palpable
