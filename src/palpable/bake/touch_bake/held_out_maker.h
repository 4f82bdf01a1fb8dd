/// @file
/// Makes the held-out touches that measure the error of a body's tables
/// (response/stated_error.h): fingers, palms and rims at random positions on the skin, solved by
/// full finite elements.
#pragma once

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/bake/touch_bake/touch_store.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/response/stated_error.h"
#include "palpable/common/response/touch_tables.h"

#include <cstdint>
#include <vector>

namespace palpable {

struct HeldOutSettings {
  int count = 20;                ///< touches: a finger, a palm, a rim, a finger, ...
  double least_depth = 0.002;    ///< m
  double largest_depth = 0.008;  ///< m; depths are uniformly random between the two
  std::uint64_t seed = 20;
  int threads = 1;
  /// m: SolidModel::largest_displacement, which some touches may leave, where the description gives
  /// it; 0: the usual one. Enters the key.
  double own_range = 0;
};

/// TouchKeys::held_out: identifies everything that the touches are computed from.
/// @param keys  of the tables
[[nodiscard]] std::uint64_t held_out_key(const TouchKeys& keys, const TouchTables& tables,
                                         const HeldOutSettings& settings);

/// The touches in the order of their numbers, without those that the full solver cannot follow to
/// their depth. The result does not depend on the number of threads, nor on which touches were read
/// from the store.
/// @param solver     of the model that `skin` belongs to
/// @param preloaded  the one that `skin` was constructed with
/// @param keys       with held_out_key(); used with `store`
/// @param store      where touches are looked up first, and stored as soon as each is solved;
///                   nullptr: every touch is solved, and none is stored
[[nodiscard]] std::vector<HeldOutTouch> make_held_out(
    const EquilibriumSolver& solver, const SkinResponse& skin, const Preloaded* preloaded,
    const TouchTables& tables, const HeldOutSettings& settings, const Progress& progress = {},
    const TouchKeys& keys = {}, const TouchStore* store = nullptr);

}  // namespace palpable
