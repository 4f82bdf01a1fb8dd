/// @file
/// For palpable bench reduce: stress computed anew from the modes of displacement, against stress
/// that is a field of its own.
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/describe/body_description.h"
#include "palpable/common/base/json.h"
#include "palpable/common/reduced/reduced_body.h"

namespace palpable::app {

/// A row for each number of displacement modes a site, and one for `body`'s own field: von Mises on
/// the skin against levels between (worst vertex, over the field's largest), bytes, microseconds.
/// Every fourth site, every fifth level.
/// @param store     of the description, complete; @param held_out  of the levels between
[[nodiscard]] Json recomputed_stress(const BodyDescription& description, const SnapshotStore& store,
                                     const SnapshotStore& held_out, const ReducedBody& body);

}  // namespace palpable::app
