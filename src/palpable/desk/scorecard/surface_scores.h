/// @file
/// The scores of the drawn surface: how deep the hand reaches into it, how it jumps, and the error
/// of its pose.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/score/statistics.h"
#include "palpable/desk/scorecard/folders.h"

#include <optional>

namespace palpable {

/// Scores named as in docs/benchmark.md.
struct SurfaceScores {
  std::optional<int> frames_too_deep;
  std::optional<int> frames_unseen;  ///< with a touch, not too deep, not seen by a camera
  std::optional<double> penetration_median_mm;
  std::optional<double> penetration_p99_mm;
  std::optional<double> penetration_median_mm_unseen;
  std::optional<double> largest_pop_mm;
  std::optional<int> largest_pop_frame;
  std::optional<int> pops_4mm;
  std::optional<MedianAndP90> placement_error_mm;
};

/// Penetration and pops are nothing when the skin (drawn_skins.h) or pose of some processed frame
/// is not known, and the placement error when a pose of the truth or the result is not known. A
/// frame that was not processed counts as the body at rest, in the pose in which the result says it
/// was drawn or else in its true pose; if neither is known, there is no penetration score, but pops
/// are scored.
/// @param body  reduced body of the run; may be null
/// @throws Error as DrawnSkins does
[[nodiscard]] SurfaceScores score_surface(const TruthFolder& truth, const ResultFolder& result,
                                          const ReducedBody* body);

}  // namespace palpable
