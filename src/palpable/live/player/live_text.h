/// @file
/// What happened in a live run, in lines for people.
#pragma once

#include "palpable/live/player/live_counts.h"
#include "palpable/live/session/session.h"

#include <string>

namespace palpable {

/// How many frames, at what pace, what went wrong, and when the body was touched.
/// @param session  that answered the frames
/// @param wall     s, by the clock on the wall
[[nodiscard]] std::string text_of(const LiveCounts& counts, const Session& session, double wall);

}  // namespace palpable
