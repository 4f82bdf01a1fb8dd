/// @file
/// Every score of docs/benchmark.md for one run: what a system made of a film, against what is
/// known of the film. Where the two folders come from is of no interest here.
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

/// The camera's path. Nothing where truth or result has no trajectory.
struct PathScores {
  std::optional<double> ate_mm;
  std::optional<double> rpe_mm;
  std::optional<double> rpe_deg;
  std::optional<double> trajectory_share;
};

/// When and where the body was pressed. Nothing where the truth has no contacts.
struct PressScores {
  std::optional<int> frames_touching;
  std::optional<double> touch_precision;
  std::optional<double> touch_recall;
  std::optional<double> touch_site;
  std::optional<int> first_touch_delay_frames;
  std::optional<double> touch_recall_3mm;
  std::optional<double> touch_false_5mm;
};

/// What is scored of one of several bodies.
struct BodyScores {
  std::string name;
  PressScores press;
  SurfaceScores surface;
  DeformedScores deformed;
};

/// By the names of docs/benchmark.md. What a result does not hold has no score.
struct Scorecard {
  int frames = 0;
  int frames_processed = 0;
  ImageScores images;
  PathScores path;
  PressScores press;
  SurfaceScores surface;
  DeformedScores deformed;
  std::vector<BodyScores> bodies = {};  ///< of several, instead of the three above
  std::optional<double> jitter_mm;
  std::optional<double> row_error_px;
  /// Of the body itself; nothing without it.
  std::optional<double> reduction_error;
  std::optional<double> reduction_error_worst;
};

[[nodiscard]] PathScores score_path(const TruthFolder& truth, const ResultFolder& result);
/// @throws Error when a touch is in a frame that the truth does not have
[[nodiscard]] PressScores score_presses(const TruthFolder& truth, const ResultFolder& result);
/// Millimetres.
[[nodiscard]] std::optional<double> score_anchor(const TruthFolder& truth,
                                                 const ResultFolder& result);
/// Pixels of the full-size picture.
[[nodiscard]] std::optional<double> score_rows(const TruthFolder& truth,
                                               const ResultFolder& result);

/// @param body  of the run; may be null
/// @throws Error naming the file, and its line where there is one, that is not as docs/benchmark.md
/// says
[[nodiscard]] Scorecard score_folders(const std::filesystem::path& truth,
                                      const std::filesystem::path& result, const ReducedBody* body,
                                      const Progress& progress);

/// One JSON object, as `palpable score --json` prints it.
[[nodiscard]] std::string json_of(const Scorecard& scores);
/// A line per score, for people.
[[nodiscard]] std::string text_of(const Scorecard& scores);

}  // namespace palpable
