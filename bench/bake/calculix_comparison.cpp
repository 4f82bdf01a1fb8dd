#include "bench/bake/calculix_comparison.h"

#include "palpable/bake/solid/stress.h"
#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>

namespace palpable {

PathDifference compare_paths(const SolidModel& model, const PathResult& ours,
                             const CalculixRun& theirs) {
  PathDifference result;
  const std::size_t levels = std::min(ours.steps.size(), theirs.states.size());
  result.levels = static_cast<int>(levels);
  for (std::size_t k = 0; k < levels; ++k) {
    const Equilibrium& mine = ours.steps[k];
    const CalculixState& other = theirs.states[k];
    PALPABLE_EXPECT(std::abs(mine.level - other.level) <= 1e-9 * mine.level, "the same levels");
    const StressField stress = point_cauchy_stress(model, mine.displacement);
    const double largest_u = mine.displacement.colwise().norm().maxCoeff();
    const double largest_stress = stress.cwiseAbs().maxCoeff();
    result.displacement =
        std::max(result.displacement,
                 (mine.displacement - other.displacement).colwise().norm().maxCoeff() / largest_u);
    result.stress =
        std::max(result.stress, (stress - other.stress).cwiseAbs().maxCoeff() / largest_stress);
    result.largest_displacement = std::max(result.largest_displacement, largest_u);
    result.largest_stress = std::max(result.largest_stress, largest_stress);
    result.smallest_volume_ratio =
        std::min(result.smallest_volume_ratio, mine.smallest_volume_ratio);
  }
  return result;
}

}  // namespace palpable
