/// @file
/// Tables of touch of a body that is baked (touch/touch_tables.h): made in stages, and kept with
/// its snapshots.
#pragma once

#include "palpable/base/progress.h"
#include "palpable/campaign/campaign.h"
#include "palpable/campaign/snapshot_store.h"
#include "palpable/describe/body_description.h"
#include "palpable/reduced/reduced_body.h"
#include "palpable/touch/touch_tables.h"

#include <functional>
#include <optional>
#include <string>

namespace palpable {

/// Vertices of the skin beyond which tables are made only where they are asked for: compliance and
/// its solves grow with the square of their number.
inline constexpr int kMostVerticesByDefault = 8000;

/// Why a body gets no tables though its description does not say "none"; empty if it gets some, or
/// if the description says so.
[[nodiscard]] std::string why_no_touch(const CampaignPlan& plan,
                                       const BodyDescription::Touch& wanted);

/// Makes the tables that are wanted, unless why_no_touch(), and the touches that tell how good they
/// are. Each is kept in the store's folder as soon as it is finished and is not made again; nothing
/// that is finished is lost, whatever ends the program.
/// @param plan  of one body, without further parameters, if tables are wanted
/// @param store  of the plan
/// @param use   is called with the tables of each stage when they can be used: with the linear
///              ones, where they are wanted with all, and with what is known of their errors
/// @throws Error when the body buckles under its preload, or a table cannot be kept
void bake_touch(const CampaignPlan& plan, const BodyDescription::Touch& wanted,
                const SnapshotStore& store, int threads,
                const std::function<void(const TouchTables&)>& use, const Progress& progress = {});

/// The tables that a bake of this very campaign has completed; nothing if none has.
[[nodiscard]] std::optional<TouchTables> kept_touch_tables(const SnapshotStore& store);

/// States in the body's provenance which tables are written beside it.
void state_touch(const TouchTables& tables, ReducedBody& body);

}  // namespace palpable
