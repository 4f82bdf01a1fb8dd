#include "palpable/bake/method_comparison.h"

#include "palpable/bake/coordinate_reduction.h"
#include "palpable/base/contract.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Adds a block of modes to the figures; (K) what is left of its snapshots, squared.
VectorXd add_block(const MatrixXd& gram, const std::vector<int>& sizes,
                   const ReductionSettings& settings, const Progress& progress,
                   MethodFigures& figures) {
  const CoordinateReduction found = reduce_in_coordinates(gram, sizes, settings, progress);
  const Index m = found.modes.F.cols();
  figures.modes = std::max(figures.modes, static_cast<int>(m));
  figures.columns += static_cast<int>(m);
  figures.ranks = found.ranks;
  if (found.ranks.empty()) {
    for (const MatrixXd& G : found.modes.G) {
      figures.parameter_values += static_cast<double>(G.size());
    }
  } else {
    double core = found.ranks[0];
    for (std::size_t j = 0; j < sizes.size(); ++j) {
      core *= found.ranks[j + 1];
      figures.parameter_values += static_cast<double>(sizes[j]) * found.ranks[j + 1];
    }
    figures.parameter_values += core;
  }
  figures.reached = figures.reached && found.reached;
  // Blocks that have met the tolerance add no further modes.
  VectorXd& all = figures.errors;
  const VectorXd& own = found.errors;
  const double met = all.size() > 0 ? all.tail(1)[0] : 0.0;
  const Index had = all.size();
  all.conservativeResize(std::max(had, own.size()));
  for (Index i = 0; i < all.size(); ++i) {
    all[i] = std::max(i < had ? all[i] : met, own[std::min(i, own.size() - 1)]);
  }
  return found.left(gram);
}

}  // namespace

MethodFigures try_method(const MatrixXd& gram, const std::vector<int>& sizes,
                         const ReductionSettings& settings, const Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  PALPABLE_EXPECT(sizes.size() >= 2, "a parameter beside the first");
  const Index K = gram.rows();
  MethodFigures figures{.method = settings.method, .reached = true};
  VectorXd left(K);
  if (settings.method == ReductionMethod::kPerSite) {
    const Index n = K / sizes[0];
    const std::vector<int> others(sizes.begin() + 1, sizes.end());
    const ReductionSettings own = settings_of_one_site(settings, sizes);
    for (Index s = 0; s < sizes[0]; ++s) {
      left.segment(s * n, n) = add_block(gram.block(s * n, s * n, n, n), others, own, {}, figures);
    }
  } else {
    left = add_block(gram, sizes, settings, progress, figures);
  }
  const VectorXd whole = gram.diagonal();
  figures.pooled = std::sqrt(left.sum() / whole.sum());
  VectorXd own = (whole.array() > 0.0).select(left.cwiseQuotient(whole).cwiseSqrt(), 0.0);
  figures.worst = own.maxCoeff();
  std::nth_element(own.begin(), own.begin() + K / 2, own.end());
  figures.median = own[K / 2];
  figures.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return figures;
}

}  // namespace palpable
