/// @file
/// The scores that compare images frame by frame: depth, moving mask, occlusion.
#pragma once

#include "palpable/common/base/progress.h"
#include "palpable/desk/score/depth_scores.h"
#include "palpable/desk/scorecard/folders.h"

#include <optional>

namespace palpable {

/// Scores named as in docs/benchmark.md; nothing when truth or result has no such images.
struct ImageScores {
  int depth_frames = 0;  ///< scored frames; 0: `depth` is empty
  DepthScore depth;
  std::optional<double> moving_iou;
  std::optional<double> moving_recall;
  std::optional<double> moving_false_positives;
  int occlusion_frames = 0;  ///< scored frames
  std::optional<double> occlusion_iou;
  std::optional<double> occlusion_iou_where_hidden;
  std::optional<double> occlusion_iou_worst_frame;
  std::optional<double> edge_error_px;  ///< px of the full-size picture
  int crossing_frames = 0;              ///< frames in which a hand crosses the outline
  std::optional<double> edge_error_crossing_px;
  std::optional<double> flicker;
};

/// Reads each image once.
/// @throws Error naming a file that cannot be read or has another size than its truth
[[nodiscard]] ImageScores score_images(const TruthFolder& truth, const ResultFolder& result,
                                       const Progress& progress);

}  // namespace palpable
