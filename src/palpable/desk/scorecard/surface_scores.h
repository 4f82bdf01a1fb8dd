/// @file
/// The scores of the drawn surface: how deep the hand is left in it, how it jumps, and how far off
/// its place it is.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/score/spread.h"
#include "palpable/desk/scorecard/folders.h"

#include <optional>

namespace palpable {

/// By the names of docs/benchmark.md.
struct SurfaceScores {
  std::optional<int> frames_too_deep;
  std::optional<int> frames_unseen;  ///< touching, not too deep, seen by no camera
  std::optional<double> penetration_median_mm;
  std::optional<double> penetration_p99_mm;
  std::optional<double> penetration_median_mm_unseen;
  std::optional<double> largest_pop_mm;
  std::optional<int> largest_pop_frame;
  std::optional<int> pops_4mm;
  std::optional<MedianAndP90> placement_error_mm;
};

/// Penetration and pops are nothing when some processed frame's skin (drawn_skins.h) or pose is not
/// known; the placement when a pose is not known, of the truth or of the result. In a frame that
/// was not processed the hand reaches into the body at rest, where the body was drawn or, if no
/// pose says so, where it truly stands; where neither is known there is no penetration, but pops
/// are.
/// @param body  of the run; may be null
/// @throws Error as DrawnSkins
[[nodiscard]] SurfaceScores score_surface(const TruthFolder& truth, const ResultFolder& result,
                                          const ReducedBody* body);

}  // namespace palpable
