/// @file
/// Computes all touch tables of one body (response/touch_tables.h): the compliance first, then the
/// regions and the cross terms between contact patches.
#pragma once

#include "palpable/bake/touch_bake/compliance_maker.h"
#include "palpable/bake/touch_bake/region_maker.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/bake/touch_bake/touch_store.h"
#include "palpable/bake/touch_bake/vibration_maker.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/response/touch_tables.h"

#include <optional>

namespace palpable {

/// Revision of the makers of tables. Raise it with every change that makes them give other numbers
/// for the same input: it is part of the key of stored tables, so that those of another revision
/// are computed again.
inline constexpr int kTouchRevision = 2;

struct CrossSettings {
  int modes = 192;        ///< a multiple of 16; 0: no cross terms
  int places = 240;       ///< positions on the skin with loads that the modes are made from
  int pairs = 700;        ///< pairs of these positions whose interaction enters the modes
  double radius = 0.007;  ///< m, radius of a load
};

struct TouchBakeSettings {
  ComplianceSettings compliance{};
  RegionSettings regions{};
  CrossSettings cross{};
  std::optional<InertiaSettings> inertia{};  ///< none: no vibration modes
  double point_spacing = 0.002;              ///< m, between contact points
  double friction = 0;  ///< TouchTables::friction; only held-out touches depend on it
  int threads = 1;
};

/// Modes of the whole body for the second-order interaction of contact patches, and the stored
/// energy in these modes.
[[nodiscard]] CrossTable make_cross_table(const SkinResponse& skin, const ModalFormMaker& forms,
                                          const CrossSettings& settings);

/// Computes all tables but those in the store. The result is the same to the byte on any number of
/// threads, and whether tables were computed or read from the store.
/// @param store  where each table is looked up first and stored as soon as it is finished; nullptr:
///               all tables are computed and none is stored
/// @throws Error as LoadResponse and make_vibration(), and when a table cannot be written
[[nodiscard]] TouchTables make_touch_tables(const SkinResponse& skin,
                                            const TouchBakeSettings& settings,
                                            const Progress& progress = {},
                                            const TouchStore* store = nullptr);

}  // namespace palpable
