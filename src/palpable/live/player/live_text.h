/// @file
/// A summary of a live run in readable lines.
#pragma once

#include "palpable/live/player/live_counts.h"
#include "palpable/live/session/session.h"

#include <string>

namespace palpable {

/// Number of frames, rate, problems and touches.
/// @param session  that processed the frames
/// @param wall     s, wall-clock time of the run
[[nodiscard]] std::string text_of(const LiveCounts& counts, const Session& session, double wall);

}  // namespace palpable
