#include "palpable/bake/touch_bake/held_out_maker.h"

#include "palpable/bake/touch_bake/touch_difference.h"
#include "palpable/bake/touch_bake/touch_scenes.h"
#include "palpable/common/base/parallel_work.h"
#include "palpable/common/geometry/digest.h"
#include "palpable/common/response/touch_solver.h"

#include <array>
#include <cstddef>
#include <limits>
#include <mutex>
#include <random>
#include <utility>

namespace palpable {
namespace {

constexpr std::array kThings{PressingThing::kFinger, PressingThing::kPalm, PressingThing::kRim};

struct Wanted {
  TouchScene scene;
  double depth = 0;  // m
};

// Whether an obstacle at this depth would lie inside a held vertex. Held vertices cannot move away,
// so the contact problem then has no solution.
bool presses_support(const SkinResponse& skin, const TouchScene& scene, double depth) {
  const ObstacleGaps gaps(obstacle_at(scene, depth));
  for (int v = 0; v < skin.vertex_count(); ++v) {
    if (skin.fixed()[v] != 0 && gaps.distance(skin.skin().vertices.col(v)) < 0) return true;
  }
  return false;
}

// The first `count` scenes of a thing that do not press the support at the largest depth.
std::vector<TouchScene> scenes_of(const SkinResponse& skin, PressingThing thing, int count,
                                  const HeldOutSettings& settings) {
  constexpr int kDrawn = 4;  // scenes drawn for each wanted one; at least one should be usable
  std::vector<TouchScene> scenes = touch_scenes(skin, thing, kDrawn * count, settings.seed);
  std::erase_if(scenes, [&](const TouchScene& scene) {
    return presses_support(skin, scene, settings.largest_depth);
  });
  if (static_cast<int>(scenes.size()) > count) scenes.resize(static_cast<std::size_t>(count));
  return scenes;
}

std::vector<Wanted> wanted_touches(const SkinResponse& skin, const HeldOutSettings& settings) {
  const int things = static_cast<int>(kThings.size());
  std::vector<std::vector<TouchScene>> scenes;
  for (const PressingThing thing : kThings) {
    scenes.push_back(scenes_of(skin, thing, (settings.count + things - 1) / things, settings));
  }
  std::mt19937_64 random(settings.seed);
  std::vector<Wanted> all;
  for (int k = 0; k < settings.count; ++k) {
    const auto share = static_cast<double>(random() % 1001) / 1000;
    const auto& of_thing = scenes[static_cast<std::size_t>(k % things)];
    const auto place = static_cast<std::size_t>(k / things);
    if (place >= of_thing.size()) continue;
    all.push_back({of_thing[place],
                   settings.least_depth + share * (settings.largest_depth - settings.least_depth)});
  }
  return all;
}

// A touch whose differences are NaN: the full solver stopped before its depth.
HeldOutTouch not_followed(const Wanted& wanted) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return {wanted.scene.thing, wanted.depth, kNone, kNone, kNone, 0.0};
}

}  // namespace

std::uint64_t held_out_key(const TouchKeys& keys, const TouchTables& tables,
                           const HeldOutSettings& settings) {
  const auto& [count, least_depth, largest_depth, seed, threads, own_range] = settings;
  constexpr int kRevision = 2;  // 2: HeldOutTouch::unscaled_error was added
  Digest digest(keys.compliance);
  digest.add(kRevision);
  digest.add(seed);
  digest.add(count);
  for (const double depth : {least_depth, largest_depth}) digest.add(depth);
  if (own_range > 0.0) digest.add(own_range);
  digest.add(tables.point_spacing);
  digest.add(tables.region_reach);
  if (tables.friction > 0.0) digest.add(tables.friction);
  if (!tables.regions.empty()) digest.add(keys.regions);
  for (const RegionTable& region : tables.regions) digest.add(region.vertex);
  if (tables.cross.cubic.variables > 0) digest.add(keys.cross);
  return digest.value();
}

std::vector<HeldOutTouch> make_held_out(const EquilibriumSolver& solver, const SkinResponse& skin,
                                        const Preloaded* preloaded, const TouchTables& tables,
                                        const HeldOutSettings& settings, const Progress& progress,
                                        const TouchKeys& keys, const TouchStore* store) {
  const std::vector<Wanted> wanted = wanted_touches(skin, settings);
  SolvedTouches solved(wanted.size());
  if (store != nullptr) {
    const auto kept = store->find_held_out(keys);
    if (kept && kept->size() == solved.size()) solved = *kept;
  }
  std::vector<std::size_t> missing;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    if (!solved[k]) missing.push_back(k);
  }
  std::mutex finished;
  const auto solve = [&](int item) {
    const std::size_t k = missing[static_cast<std::size_t>(item)];
    TouchSolver touch(skin.skin(), skin.fixed(), tables);
    HeldOutTouch found = not_followed(wanted[k]);
    (void)compare_touch(solver, skin, preloaded, touch, tables.point_spacing, wanted[k].scene,
                        std::array{wanted[k].depth},
                        [&](const TouchDifference& difference) { found = difference.touch; },
                        {.friction = tables.friction});
    const std::scoped_lock turn(finished);
    solved[k] = found;
    if (store != nullptr) store->keep(keys, solved);
  };
  work_in_parallel(static_cast<int>(missing.size()), settings.threads,
                   "touch: held-out touches in full", progress, solve);
  return followed(solved);
}

}  // namespace palpable
