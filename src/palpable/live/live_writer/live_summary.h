/// @file
/// live.json of a run (clip_files/live_file.h), from the run itself.
#pragma once

#include "palpable/desk/clip_files/live_file.h"
#include "palpable/live/live_writer/live_output.h"
#include "palpable/live/player/live_counts.h"
#include "palpable/live/player/live_run.h"
#include "palpable/live/player/run_stats.h"

namespace palpable {

/// What a run that has ended says of itself. What only the user knows is left as it is: body,
/// contact, view, scale, wall.
/// @param figures  of all of it
/// @param output   after finish()
[[nodiscard]] LiveSummary summary_of(const LiveRun& run, const LiveCounts& counts,
                                     const RunFigures& figures, const LiveOutput& output);

}  // namespace palpable
