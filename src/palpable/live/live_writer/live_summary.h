/// @file
/// live.json of a run (clip_files/live_file.h), from the run itself.
#pragma once

#include "palpable/desk/clip_files/live_file.h"
#include "palpable/live/live_writer/live_output.h"
#include "palpable/live/player/live_counts.h"
#include "palpable/live/player/live_run.h"
#include "palpable/live/player/run_stats.h"

namespace palpable {

/// The summary of a run that has ended. Members that only the user's options determine are not
/// filled in: body, contact, view, scale, wall.
/// @param figures  of the complete run
/// @param output   after finish(); null: no files were written
[[nodiscard]] LiveSummary summary_of(const LiveRun& run, const LiveCounts& counts,
                                     const RunFigures& figures, const LiveOutput* output);

/// Fills in what a run without a camera has, too: touches, speed, processed frames, pictures.
/// @param counts, figures, output  as above
void add_contact(const LiveCounts& counts, const RunFigures& figures, const LiveOutput* output,
                 LiveSummary& result);

}  // namespace palpable
