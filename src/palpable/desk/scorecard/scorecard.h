/// @file
/// Every score of docs/benchmark.md for one run: the result of a system that processed a film,
/// compared with the truth of the film. The folders may come from any program.
#pragma once

#include "palpable/common/base/progress.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/clip_files/live_file.h"
#include "palpable/desk/scorecard/body_scores.h"
#include "palpable/desk/scorecard/image_scores.h"

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
  std::optional<double> trajectory_coverage;
};

/// Scores named as in docs/benchmark.md; nothing when the result lacks the files for them.
struct Scorecard {
  std::string truth, result;  ///< the folders that were compared, as they were given
  std::string film;           ///< name of the sequence; empty: not known
  RunSpeed speed;
  int frames = 0;
  int frames_processed = 0;
  ImageScores images;
  PathScores path;
  BodyScores body;
  std::vector<BodyScores> bodies = {};  ///< of a film with several bodies, instead of `body`
  std::optional<double> jitter_mm;      ///< of the drawn body in the world
  std::optional<double> row_error_px;   ///< the largest, px of the full-size picture
  /// Errors of the reduced body itself, from its file; nothing without it.
  std::optional<double> reduction_error;
  std::optional<double> reduction_error_worst;
};

/// @param body  reduced body of the run; may be null
/// @throws Error naming the file, and the line if there is one, that does not follow
/// docs/benchmark.md
[[nodiscard]] Scorecard score_folders(const std::filesystem::path& truth,
                                      const std::filesystem::path& result, const ReducedBody* body,
                                      const Progress& progress);

}  // namespace palpable
