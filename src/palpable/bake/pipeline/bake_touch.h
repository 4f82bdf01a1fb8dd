/// @file
/// Tables of touch of a body that is baked (response/touch_tables.h): made in stages, and kept with
/// its snapshots.
#pragma once

#include "palpable/bake/campaign/campaign.h"
#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/describe/body_description.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/touch_tables.h"

#include <functional>
#include <optional>
#include <string>

namespace palpable {

/// Makes the tables that are wanted, on the body's mesh or on a coarser one that carries it
/// (describe/touch_mesh.h), and the touches that tell how good they are, against the full answer on
/// the same mesh. Each is kept in the store's folder as soon as it is finished and is not made
/// again; nothing that is finished is lost, whatever ends the program.
/// @param plan  of the description: one body, without further parameters, if tables are wanted
/// @param store  of the plan
/// @param use   is called with the tables of each stage when they can be used: with the linear
///              ones, where they are wanted with all, and with what is known of their errors
/// @returns why there are none though the description does not say "none": no
///          coarser mesh could be made for a fine skin, where nobody asked for them; empty
///          otherwise
/// @throws Error when the body buckles under its preload, tables that were asked for can have no
///         mesh, or one cannot be kept
std::string bake_touch(const BodyDescription& description, const CampaignPlan& plan,
                       const SnapshotStore& store, int threads,
                       const std::function<void(const TouchTables&)>& use,
                       const Progress& progress = {});

/// The tables that a bake of this very campaign has completed; nothing if none has.
[[nodiscard]] std::optional<TouchTables> kept_touch_tables(const SnapshotStore& store);

/// States in the body's provenance which tables are written beside it.
void state_touch(const TouchTables& tables, ReducedBody& body);

}  // namespace palpable
