/// @file
/// Makes the tables of touch of a body (response/touch_tables.h) in stages and stores them with its
/// snapshots.
#pragma once

#include "palpable/bake/campaign/campaign.h"
#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/touch_bake/touch_maker.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/touch_tables.h"

#include <functional>
#include <optional>
#include <string>

namespace palpable {

/// Makes the tables that the description requests, on the body's mesh or on a coarser one that
/// carries its skin (describe/touch_mesh.h), and held-out touches, which measure the tables' error
/// against full-order solutions on the same mesh. Each table is stored in the store's folder as
/// soon as it is finished and is not made again, so an aborted run loses only the one in progress.
/// @param plan  of the description; has one point if tables are requested
/// @param store  of the plan
/// @param use   called with the tables after each stage: with the linear ones, with all of them if
///              they are requested, and with the held-out touches added. The last stage is
///              kFinished
/// @returns the reason why there are no tables, where they were not requested explicitly and no
///          coarser mesh could be made for a fine skin; empty otherwise
/// @throws Error when the body has no equilibrium under its preload, no mesh can be made for
///         requested tables, or a table cannot be written
std::string bake_touch(const BodyDescription& description, const CampaignPlan& plan,
                       const SnapshotStore& store, int threads,
                       const std::function<void(const TouchTables&, BodyStage)>& use,
                       const Progress& progress = {});

/// How the full tables of a description are made. Linear ones have no regions and no cross modes.
[[nodiscard]] TouchBakeSettings touch_settings(const BodyDescription& description, int threads);

/// How far the bake of these tables had come: before kFinished, more of them were requested.
[[nodiscard]] BodyStage kept_touch_stage(const SnapshotStore& store);

/// The complete tables of an earlier bake of the same campaign; nothing if there are none.
[[nodiscard]] std::optional<TouchTables> kept_touch_tables(const SnapshotStore& store);

}  // namespace palpable
