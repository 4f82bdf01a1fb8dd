/// @file
/// Makes the held-out touches that measure the error of a body's tables
/// (response/held_out_touch.h): fingers, palms and rims at random positions on the skin, solved by
/// full finite elements.
#pragma once

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/bake/touch_bake/touch_store.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/response/held_out_touch.h"
#include "palpable/common/response/touch_tables.h"

#include <cstdint>
#include <vector>

namespace palpable {

struct HeldOutSettings {
  int count = 20;                ///< of touches: a finger, a palm, a rim, a finger, ...
  double least_depth = 0.002;    ///< m
  double largest_depth = 0.008;  ///< m; depths lie evenly at random between the two
  std::uint64_t seed = 20;
  int threads = 1;
};

/// What the touches are computed from, as TouchKeys::held_out.
/// @param keys  of the tables
[[nodiscard]] std::uint64_t held_out_key(const TouchKeys& keys, const TouchTables& tables,
                                         const HeldOutSettings& settings);

/// In the order of their numbers; those that the full solver cannot follow to their depth are left
/// out. The same on any number of threads, and whether touches were kept or solved.
/// @param solver     of the model that `skin` belongs to
/// @param preloaded  as `skin` was made with
/// @param keys       with held_out_key(); each touch is kept as soon as it is solved, and looked
///                   for first
/// @param store      nullptr: nowhere
[[nodiscard]] std::vector<HeldOutTouch> make_held_out(
    const EquilibriumSolver& solver, const SkinResponse& skin, const Preloaded* preloaded,
    const TouchTables& tables, const HeldOutSettings& settings, const Progress& progress = {},
    const TouchKeys& keys = {}, const TouchStore* store = nullptr);

}  // namespace palpable
