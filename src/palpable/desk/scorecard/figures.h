/// @file
/// The list of all figures of `palpable score`: the name of each in JSON, and its line for people.
/// Whoever adds a score adds it to the list in figures.cpp.
#pragma once

#include "palpable/desk/scorecard/pose_scores.h"
#include "palpable/desk/scorecard/scorecard.h"

#include <string>

namespace palpable {

/// One JSON object, as `palpable score --json` prints it; what is not known is null.
[[nodiscard]] std::string json_of(const Scorecard& scores);
[[nodiscard]] std::string json_of(const PoseScores& scores);
/// A line for each score; "-" for what is not known.
[[nodiscard]] std::string text_of(const Scorecard& scores);
[[nodiscard]] std::string text_of(const PoseScores& scores);

}  // namespace palpable
