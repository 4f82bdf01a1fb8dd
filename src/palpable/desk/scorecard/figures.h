/// @file
/// The list of all figures of `palpable score`: the name of each in JSON, and its line for people.
///
/// To add a score:
///
///   1. Compute it from arrays in the file of its subject in score/ (touch_scores.h,
///      skin_scores.h, ...), with a case in the test beside it.
///   2. Give it a member, filled from the folders of truth and result, in this module:
///   body_scores.h
///      for what a body does, image_scores.h for pictures, pose_scores.h for the camera,
///      scorecard.h for the rest. A file that was not read before gets its reader in clip_files.
///   3. List its name in JSON and its line in figures.cpp, and its target if docs/ state one.
///   4. Explain it in docs/benchmark.md; tests/cli/programs.py scores whole runs.
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/desk/scorecard/pose_scores.h"
#include "palpable/desk/scorecard/scorecard.h"

#include <string>

namespace palpable {

/// An object with all figures, as `palpable score --json` prints it; what is not known is null.
[[nodiscard]] Json json_of(const Scorecard& scores);
[[nodiscard]] Json json_of(const PoseScores& scores);
/// Text for people. Three lines say what was compared, how good the result is and how fast it was;
/// all figures follow under headings, with "-" for what is not known. A figure for which the
/// project states a target has a verdict beside it: "ok (target: at most 1 mm)" or "missed (...)".
[[nodiscard]] std::string text_of(const Scorecard& scores);
[[nodiscard]] std::string text_of(const PoseScores& scores);

}  // namespace palpable
