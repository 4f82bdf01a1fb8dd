/// @file
/// Our path and CalculiX' on the same mesh under the same loads, state by state.
#pragma once

#include "palpable/bake/campaign/calculix.h"
#include "palpable/bake/solid/equilibrium.h"

namespace palpable {

/// Over all levels that both reached. Differences are the largest over nodes (displacement,
/// Euclidean norm) or integration points (Cauchy stress, any component), relative to the largest
/// value of that level; of the levels, the worst.
struct PathDifference {
  double displacement = 0;
  double stress = 0;
  int levels = 0;                   ///< compared
  double largest_displacement = 0;  ///< m, ours, over all levels
  double largest_stress = 0;        ///< Pa, likewise, any component
  double smallest_volume_ratio = 1;
};

/// What both programs are held to when both solve to 1e-8; CalculiX prints seven digits.
inline constexpr double kDisplacementBar = 1e-6, kStressBar = 1e-5;

/// @pre both are paths of `model`, and their levels agree as far as both go
[[nodiscard]] PathDifference compare_paths(const SolidModel& model, const PathResult& ours,
                                           const CalculixRun& theirs);

}  // namespace palpable
