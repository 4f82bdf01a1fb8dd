/// @file
/// Comparison of our path with CalculiX's on the same mesh under the same loads, state by state.
#pragma once

#include "palpable/bake/calculix/calculix.h"
#include "palpable/bake/solid/equilibrium.h"

namespace palpable {

/// Differences over all levels that both programs reached: the largest over nodes (displacement,
/// Euclidean norm) or integration points (Cauchy stress, any component), relative to the largest
/// value of that level; of the worst level.
struct PathDifference {
  double displacement = 0;
  double stress = 0;
  int levels = 0;                   ///< number of levels compared
  double largest_displacement = 0;  ///< m, of our path, over all levels
  double largest_stress = 0;        ///< Pa, of our path, over all levels, any component
  double smallest_volume_ratio = 1;
};

/// Allowed differences when both programs solve to 1e-8. CalculiX prints seven digits.
inline constexpr double kDisplacementLimit = 1e-6, kStressLimit = 1e-5;

/// @pre both are paths of `model` with the same levels, up to the end of the shorter one
[[nodiscard]] PathDifference compare_paths(const SolidModel& model, const PathResult& ours,
                                           const CalculixRun& theirs);

}  // namespace palpable
