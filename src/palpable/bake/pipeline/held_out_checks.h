/// @file
/// How wrong a baked body is where it was not made from, stated in the body itself: states between
/// its own are solved afresh, which takes as long as the campaign did.
#pragma once

#include "palpable/bake/pipeline/bake_body.h"

namespace palpable {

/// Solves the levels half way between those of the campaign into NAME.held-out beside the
/// campaign's NAME.snapshots; the body's provenance, error.held_out and the report say how far it
/// is from them.
/// @param settings  of the campaign
/// @param point     of the campaign, where the body's further parameters are or usually are
/// @throws Error as fill_store()
void check_between_levels(const BodyDescription& description, FillSettings settings,
                          const SnapshotStore& campaign, int point, BakedBody& baked,
                          const Progress& progress = {});

/// The same for values half way between the samples of the body's free parameters, one parameter
/// at a time, the others at their usual values; at equal depth. Snapshots go to
/// NAME.between-PARAMETER. Does nothing where no parameter is free.
void check_between_values(const BodyDescription& description, FillSettings settings,
                          const SnapshotStore& campaign, BakedBody& baked,
                          const Progress& progress = {});

}  // namespace palpable
