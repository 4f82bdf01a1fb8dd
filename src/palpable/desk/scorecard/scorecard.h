/// @file
/// Every score of docs/benchmark.md for one run: the result of a system that processed a film,
/// compared with the truth of the film. The folders may come from any program.
#pragma once

#include "palpable/common/base/progress.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/scorecard/deformed_scores.h"
#include "palpable/desk/scorecard/folders.h"
#include "palpable/desk/scorecard/image_scores.h"
#include "palpable/desk/scorecard/surface_scores.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// Scores of the camera's path; nothing when truth or result has no trajectory.
struct PathScores {
  std::optional<double> ate_mm;
  std::optional<double> rpe_mm;
  std::optional<double> rpe_deg;
  std::optional<double> trajectory_share;
};

/// Scores of when and where touches were felt; nothing when the truth has no contacts.
struct PressScores {
  std::optional<int> frames_touching;
  std::optional<double> touch_precision;
  std::optional<double> touch_recall;
  std::optional<double> touch_site;
  std::optional<int> first_touch_delay_frames;
  std::optional<double> touch_recall_3mm;
  std::optional<double> touch_false_5mm;
};

/// The scores of one of several bodies.
struct BodyScores {
  std::string name;
  PressScores press;
  SurfaceScores surface;
  DeformedScores deformed;
};

/// Scores named as in docs/benchmark.md; nothing when the result lacks the files for them.
struct Scorecard {
  int frames = 0;
  int frames_processed = 0;
  ImageScores images;
  PathScores path;
  PressScores press;
  SurfaceScores surface;
  DeformedScores deformed;
  std::vector<BodyScores> bodies =
      {};  ///< of a film with several bodies, instead of the three above
  std::optional<double> jitter_mm;
  std::optional<double> row_error_px;
  /// Errors of the reduced body itself, from its file; nothing without it.
  std::optional<double> reduction_error;
  std::optional<double> reduction_error_worst;
};

[[nodiscard]] PathScores score_path(const TruthFolder& truth, const ResultFolder& result);
/// @throws Error when a touch is in a frame that the truth does not have
[[nodiscard]] PressScores score_presses(const TruthFolder& truth, const ResultFolder& result);
/// Jitter of the drawn body in the world, mm.
[[nodiscard]] std::optional<double> score_anchor(const TruthFolder& truth,
                                                 const ResultFolder& result);
/// Largest row error, px of the full-size picture.
[[nodiscard]] std::optional<double> score_rows(const TruthFolder& truth,
                                               const ResultFolder& result);

/// @param body  reduced body of the run; may be null
/// @throws Error naming the file, and the line if there is one, that does not follow
/// docs/benchmark.md
[[nodiscard]] Scorecard score_folders(const std::filesystem::path& truth,
                                      const std::filesystem::path& result, const ReducedBody* body,
                                      const Progress& progress);

/// One JSON object, as `palpable score --json` prints it.
[[nodiscard]] std::string json_of(const Scorecard& scores);
/// One line per score, for people.
[[nodiscard]] std::string text_of(const Scorecard& scores);

}  // namespace palpable
