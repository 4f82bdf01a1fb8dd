#include "palpable/bake/separate/cp_als.h"

#include "palpable/bake/separate/greedy_pgd.h"
#include "palpable/common/base/contract.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpable {

Separation cp_als(const SnapshotTensor& snapshots, const ReductionGoal& goal,
                  const CpSettings& settings, const Progress& progress) {
  PALPABLE_EXPECT(goal.max_modes >= 1 && goal.tolerance > 0.0, "a goal that ends");
  PALPABLE_EXPECT(settings.max_sweeps >= 1, "at least one sweep");
  const GreedySettings start{.update_all = false};
  GreedyPgd modes(snapshots, start);
  Separation result;
  std::vector<double> errors;
  std::vector<Eigen::VectorXd> left;
  const double total = -std::log10(goal.tolerance);
  while (static_cast<int>(errors.size()) < goal.max_modes && !result.reached) {
    modes.add_mode();
    const bool last = static_cast<int>(errors.size()) + 1 == goal.max_modes;
    for (int sweep = 0; sweep < settings.max_sweeps; ++sweep) {
      const double before = modes.error();
      if (before <= goal.tolerance || !modes.improve()) break;
      if (before > 2.0 * goal.tolerance && !last) break;
      if (modes.error() > (1.0 - settings.sweep_tolerance) * before) break;
    }
    errors.push_back(modes.error());
    left.push_back(modes.left());
    result.reached = errors.back() <= goal.tolerance;
    const double done = std::min(total, -std::log10(std::max(errors.back(), goal.tolerance)));
    report(progress, {"separating", std::max(0.0, done), std::max(total, 1e-9),
                      fmt::format("{} modes, error {:.2g}", errors.size(), errors.back())});
  }
  result.errors =
      Eigen::Map<const Eigen::VectorXd>(errors.data(), static_cast<Eigen::Index>(errors.size()));
  result.left.resize(result.errors.size(), snapshots.values.cols());
  for (Eigen::Index i = 0; i < result.left.rows(); ++i) {
    result.left.row(i) = left[i].transpose();
  }
  result.separated = modes.separated();
  return result;
}

}  // namespace palpable
