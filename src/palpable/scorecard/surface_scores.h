/// @file
/// The scores of the drawn surface: how deep the hand is left in it, and how it jumps.
#pragma once

#include "palpable/reduced/reduced_body.h"
#include "palpable/scorecard/folders.h"

#include <optional>

namespace palpable {

/// By the names of docs/benchmark.md.
struct SurfaceScores {
  std::optional<int> frames_too_deep;
  std::optional<double> penetration_median_mm;
  std::optional<double> penetration_p99_mm;
  std::optional<double> largest_pop_mm;
  std::optional<int> largest_pop_frame;
  std::optional<int> pops_4mm;
};

/// Penetration and pops are nothing when some frame's skin (drawn_skins.h) or pose is not known.
/// @param body  of the run; may be null
/// @throws Error as DrawnSkins
[[nodiscard]] SurfaceScores score_surface(const TruthFolder& truth, const ResultFolder& result,
                                          const ReducedBody* body);

}  // namespace palpable
