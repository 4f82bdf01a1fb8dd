/// @file
/// The scores of the drawn surface: how deep the hand is left in it, and how it jumps.
#pragma once

#include "palpable/reduced/reduced_body.h"
#include "palpable/scorecard/folders.h"

#include <optional>

namespace palpable {

/// By the names of docs/benchmark.md.
struct SurfaceScores {
  std::optional<double> penetration_median_mm;
  std::optional<double> penetration_p99_mm;
  std::optional<double> largest_pop_mm;
  std::optional<int> largest_pop_frame;
};

/// The surface of a frame is RESULT/meshes/%06d.ply where there is such a folder, else the body
/// deformed by the frame's touch (site and level). Nothing when neither is at hand, when a touch
/// does not say both, or when the result has no pose.
/// @param body  of the run; may be null
/// @throws Error naming the file that cannot be read, or the site that `body` does not have
[[nodiscard]] SurfaceScores score_surface(const TruthFolder& truth, const ResultFolder& result,
                                          const ReducedBody* body);

}  // namespace palpable
