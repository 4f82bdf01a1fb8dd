/// @file
/// For palpable bench reduce: compares stress computed from the modes of displacement with stress
/// stored as a field of its own.
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/describe/body_description.h"
#include "palpable/common/base/json.h"
#include "palpable/common/reduced/reduced_body.h"

namespace palpable::app {

/// A row for each number of displacement modes per site, and one for the stress field of `body`:
/// error of von Mises stress on the skin at intermediate levels (worst vertex / largest value of
/// the field), bytes, us. Uses every fourth site and every fifth level.
/// @param store     the complete campaign of the description
/// @param held_out  snapshots of the intermediate levels
[[nodiscard]] Json recomputed_stress(const BodyDescription& description, const SnapshotStore& store,
                                     const SnapshotStore& held_out, const ReducedBody& body);

}  // namespace palpable::app
