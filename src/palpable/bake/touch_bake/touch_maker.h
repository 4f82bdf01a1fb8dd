/// @file
/// All tables of touch of one body (response/touch_tables.h), in stages that can be used as soon as
/// they are there: the linear answer first, then the regions, then what touches do to each other.
#pragma once

#include "palpable/bake/touch_bake/compliance_maker.h"
#include "palpable/bake/touch_bake/region_maker.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/bake/touch_bake/touch_store.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/response/touch_tables.h"

namespace palpable {

/// To be raised by whoever changes what the makers of tables answer for the same question: tables
/// that are kept carry it, and those of another revision are made again.
inline constexpr int kTouchRevision = 2;

struct CrossSettings {
  int modes = 192;        ///< a multiple of 16; 0: none
  int places = 240;       ///< spread over the skin, of the loads that the modes are made from
  int pairs = 700;        ///< of loads at two of them
  double radius = 0.007;  ///< m, of a load
};

struct TouchBakeSettings {
  ComplianceSettings compliance{};
  RegionSettings regions{};
  CrossSettings cross{};
  double point_spacing = 0.002;  ///< m, of contact points
  int threads = 1;
};

/// Modes of the whole body in which patches of load act on each other.
[[nodiscard]] CrossTable make_cross_table(const SkinResponse& skin, const ModalFormMaker& forms,
                                          const CrossSettings& settings);

/// The same bytes on any number of threads, and whether tables were kept or made.
/// @param store  where each table is kept as soon as it is finished, and looked for first; nullptr:
///               nowhere
/// @throws Error as LoadResponse, and when a table cannot be kept
[[nodiscard]] TouchTables make_touch_tables(const SkinResponse& skin,
                                            const TouchBakeSettings& settings,
                                            const Progress& progress = {},
                                            const TouchStore* store = nullptr);

}  // namespace palpable
