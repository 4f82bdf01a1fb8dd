/// @file
/// Measures the error of a baked body at held-out states, between the states that it was made from,
/// and states it in the body. The held-out states are solved in full, which takes as long as the
/// campaign did.
#pragma once

#include "palpable/bake/pipeline/bake_body.h"

namespace palpable {

/// Solves the levels half way between those of the campaign into NAME.held-out beside the
/// campaign's NAME.snapshots; the errors go into the body's provenance, its error.held_out and the
/// report.
/// @param settings  of the campaign
/// @param point     of the campaign at which the body's further parameters have their usual values
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
