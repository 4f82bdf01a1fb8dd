/// @file
/// All tables of touch of one body (touch/touch_tables.h), in stages that can be used as soon as
/// they are there: the linear answer first, then the regions, then what touches do to each other.
#pragma once

#include "palpable/base/progress.h"
#include "palpable/touch/touch_tables.h"
#include "palpable/touch_bake/compliance_maker.h"
#include "palpable/touch_bake/region_maker.h"
#include "palpable/touch_bake/skin_response.h"

namespace palpable {

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

/// @throws Error as LoadResponse
[[nodiscard]] TouchTables make_touch_tables(const SkinResponse& skin,
                                            const TouchBakeSettings& settings,
                                            const Progress& progress = {});

}  // namespace palpable
