#include "palpable/bake/separate/method_comparison.h"

#include "palpable/bake/separate/coordinate_reduction.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/order_statistics.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Figures of one block after 1, 2, ... m of its modes.
struct Course {
  MatrixXd left;              // (m x K) squared norm of each snapshot's residual
  VectorXd parameter_values;  // (m) how many numbers the functions of the parameters hold
};

// How many numbers the functions of the parameters hold at i modes; for a Tucker form with i
// functions of space the core is included.
double parameter_values(const CoordinateReduction& found, const std::vector<int>& sizes, Index i) {
  double values = 0;
  if (found.ranks.empty()) {
    for (const MatrixXd& G : found.modes.G) values += static_cast<double>(G.rows() * i);
    return values;
  }
  auto core = static_cast<double>(i);
  for (std::size_t j = 0; j < sizes.size(); ++j) {
    core *= found.ranks[j + 1];
    values += static_cast<double>(sizes[j]) * found.ranks[j + 1];
  }
  return values + core;
}

// Reduces one block and adds its modes and errors to the figures.
Course add_block(const MatrixXd& gram, const std::vector<int>& sizes,
                 const ReductionSettings& settings, const Progress& progress,
                 MethodFigures& figures) {
  const CoordinateReduction found = reduce_in_coordinates(gram, sizes, settings, progress);
  const Index m = found.modes.F.cols();
  figures.modes = std::max(figures.modes, static_cast<int>(m));
  figures.columns += static_cast<int>(m);
  figures.ranks = found.ranks;
  Course course{found.course(gram), VectorXd(m)};
  for (Index i = 0; i < m; ++i) course.parameter_values[i] = parameter_values(found, sizes, i + 1);
  course.left.bottomRows(1) = found.left(gram).transpose();
  figures.parameter_values += course.parameter_values[m - 1];
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
  return course;
}

// The figures with up to i modes in each block. @param whole  (K) squared norms of the snapshots
MethodStep step_of(const std::vector<Course>& blocks, const VectorXd& whole, Index i) {
  MethodStep step{.modes = static_cast<int>(i)};
  const Index K = whole.size(), n = K / static_cast<Index>(blocks.size());
  VectorXd left(K);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Index mine = std::min(i, blocks[b].left.rows());
    step.columns += static_cast<int>(mine);
    step.parameter_values += blocks[b].parameter_values[mine - 1];
    left.segment(static_cast<Index>(b) * n, n) = blocks[b].left.row(mine - 1).transpose();
  }
  step.pooled = std::sqrt(left.sum() / whole.sum());
  VectorXd own = (whole.array() > 0.0).select(left.cwiseQuotient(whole).cwiseSqrt(), 0.0);
  step.worst = own.maxCoeff();
  step.median = upper_median(std::span(own.data(), static_cast<std::size_t>(K)));
  return step;
}

}  // namespace

MethodFigures try_method(const MatrixXd& gram, const std::vector<int>& sizes,
                         const ReductionSettings& settings, const Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  PALPABLE_EXPECT(sizes.size() >= 2, "a parameter beside the first");
  const Index K = gram.rows();
  MethodFigures figures{.method = settings.method, .reached = true};
  std::vector<Course> blocks;
  if (settings.method == ReductionMethod::kPerSite) {
    const Index n = K / sizes[0];
    const std::vector<int> others(sizes.begin() + 1, sizes.end());
    const ReductionSettings own = settings_of_one_site(settings, sizes);
    for (Index s = 0; s < sizes[0]; ++s) {
      blocks.push_back(add_block(gram.block(s * n, s * n, n, n), others, own, {}, figures));
    }
  } else {
    blocks.push_back(add_block(gram, sizes, settings, progress, figures));
  }
  const VectorXd whole = gram.diagonal();
  for (Index i = 1; i <= figures.modes; ++i) figures.steps.push_back(step_of(blocks, whole, i));
  const MethodStep& last = figures.steps.back();
  figures.pooled = last.pooled;
  figures.median = last.median;
  figures.worst = last.worst;
  figures.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return figures;
}

}  // namespace palpable
