#include "palpable/bake/separate/reduction.h"

#include "palpable/bake/separate/coordinate_reduction.h"
#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/bake/separate/pod.h"
#include "palpable/bake/separate/site_bases.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::array<std::pair<ReductionMethod, std::string_view>, 6> kNames{
    {{ReductionMethod::kPerSite, "per-site"},
     {ReductionMethod::kPgd, "pgd"},
     {ReductionMethod::kPgd2, "pgd2"},
     {ReductionMethod::kPod, "pod"},
     {ReductionMethod::kCp, "cp"},
     {ReductionMethod::kHosvd, "hosvd"}}};

// Fills in the errors. @param lost, whole  (K) squared norms of each snapshot's residual and of the
// snapshot. @param course  (m x K) squared norm of each residual after 1, 2, ... modes
void set_errors(const VectorXd& lost, const VectorXd& whole, MatrixXd course, Reduction& result) {
  course.row(course.rows() - 1) = lost.transpose();
  result.pooled_course = (course.rowwise().sum() / whole.sum()).cwiseSqrt();
  result.course = std::move(course);
  for (Index k = 0; k < whole.size(); ++k) {
    if (whole[k] > 0.0) {
      result.course.col(k) = (result.course.col(k) / whole[k]).cwiseSqrt();
    } else {
      result.course.col(k).setZero();
    }
  }
  result.error = result.pooled_course.tail(1)[0];
  result.snapshot_errors = result.course.bottomRows(1).transpose();
}

// Adds the squared norm of each snapshot, a column of A, to `whole`, and that of its residual
// A - F table to `lost`, weighted by w. A holds some snapshots, or some rows of them.
// @param table  (modes x snapshots) what multiplies each mode in each snapshot
void measure(const MatrixXd& A, const MatrixXd& F, const MatrixXd& table, const VectorXd& w,
             Eigen::Ref<VectorXd> lost, Eigen::Ref<VectorXd> whole) {
  MatrixXd left = A;
  subtract_product(F, table, left);
  for (Index k = 0; k < A.cols(); ++k) {
    whole[k] += A.col(k).cwiseAbs2().dot(w);
    lost[k] += left.col(k).cwiseAbs2().dot(w);
  }
}

MatrixXd table_of(const SeparatedTensor& separated) {
  std::vector<int> sizes;
  for (const MatrixXd& G : separated.G) sizes.push_back(static_cast<int>(G.rows()));
  return parameter_products(separated.G, sizes);  // (K x m)
}

struct Block {
  SeparatedTensor separated;
  VectorXd errors;       // (m) relative, after 1, 2, ... modes
  VectorXd lost, whole;  // (K) squared norms of each snapshot's residual and of the snapshot
  bool reached = false;
  MatrixXd course = {};  // (m x K) squared norm of each residual after 1, 2, ... modes
};

// Bytes of a table of snapshots above which it is read in blocks of rows and only its Gram matrix
// is kept. Below, a third of the table is kept in memory (site_bases.h).
constexpr double kTableInMemory = 2e9;

// Reduces all snapshots to one separated tensor.
Block reduce_to_one(const SnapshotRows& snapshots, const VectorXd& weights,
                    const ReductionSettings& settings, const Progress& progress,
                    Reduction& result) {
  const Index K = snapshot_count(snapshots.sizes), n = K / snapshots.sizes[0];
  const bool by_sites =
      snapshots.sizes.size() > 1 &&
      8.0 * static_cast<double>(snapshots.values) * static_cast<double>(K) <= kTableInMemory;
  report(progress, {"products of snapshots", 0.0, 1.0, ""});
  std::optional<SiteBases> bases;
  if (by_sites) bases = site_bases(snapshots, weights, kCoordinatesShare * settings.tolerance);
  const MatrixXd gram = by_sites ? std::move(bases->gram) : gram_of(snapshots, weights);
  report(progress, {"products of snapshots", 1.0, 1.0, ""});
  CoordinateReduction found = reduce_in_coordinates(gram, snapshots.sizes, settings, progress);
  MatrixXd course = found.course(gram);
  Block block{{{}, std::move(found.modes.G)},
              std::move(found.errors),
              VectorXd::Zero(K),
              VectorXd::Zero(K),
              found.reached,
              std::move(course)};
  result.ranks = found.ranks;
  result.bound = found.bound;
  MatrixXd& F = block.separated.F;
  const MatrixXd combination = found.combination(), table = table_of(block.separated);
  if (by_sites) {
    F = bases->combine(combination, weights);
    bases.reset();
    for (int s = 0; s < snapshots.sizes[0]; ++s) {
      measure(snapshots.read_first(s), F, table.middleRows(s * n, n), weights,
              block.lost.segment(s * n, n), block.whole.segment(s * n, n));
    }
    return block;
  }
  F.resize(snapshots.values, combination.cols());
  for_blocks(snapshots, [&](Index first, const MatrixXd& A) {
    const MatrixXd rows = times(A, combination);
    F.middleRows(first, A.rows()) = rows;
    measure(A, rows, table, weights.segment(first, A.rows()), block.lost, block.whole);
  });
  return block;
}

Block reduce_one_site(const SnapshotTensor& here, const VectorXd& weights,
                      const ReductionSettings& settings) {
  if (!here.values.allFinite()) throw Error("a snapshot holds values that are not numbers");
  const Index n = here.values.cols();
  MatrixXd gram = MatrixXd::Zero(n, n);
  add_gram(weights.cwiseSqrt().asDiagonal() * here.values, gram);
  CoordinateReduction found = reduce_in_coordinates(gram, here.sizes, settings);
  MatrixXd course = found.course(gram);
  Block block{{times(here.values, found.combination()), std::move(found.modes.G)},
              std::move(found.errors),
              VectorXd::Zero(n),
              VectorXd::Zero(n),
              found.reached,
              std::move(course)};
  measure(here.values, block.separated.F, table_of(block.separated), weights, block.lost,
          block.whole);
  return block;
}

Reduction reduce_per_site(const SnapshotRows& snapshots, const VectorXd& weights,
                          const ReductionSettings& settings, const Progress& progress) {
  PALPABLE_EXPECT(snapshots.sizes.size() >= 2, "a parameter beside the site");
  const int S = snapshots.sizes[0];
  const Index n = snapshot_count(snapshots.sizes) / S;
  const ReductionSettings own = settings_of_one_site(settings, snapshots.sizes);
  Reduction result;
  result.reached = true;
  VectorXd lost = VectorXd::Zero(S * n), whole = lost;
  std::vector<MatrixXd> courses;
  for (int s = 0; s < S; ++s) {
    const SnapshotTensor here{snapshots.read_first(s),
                              {snapshots.sizes.begin() + 1, snapshots.sizes.end()}};
    PALPABLE_EXPECT(here.values.cols() == n, "the snapshots that were asked for");
    if (here.values.isZero(0.0)) {
      throw Error(fmt::format("all snapshots of site {} are zero: there is nothing to reduce", s));
    }
    const Block block = reduce_one_site(here, weights, own);
    result.reached = result.reached && block.reached;
    // A site that has met the tolerance adds no further modes.
    const Index most = std::max(result.errors.size(), block.errors.size());
    const Index had = result.errors.size();
    const double met = had > 0 ? result.errors[had - 1] : 0.0;
    result.errors.conservativeResize(most);
    for (Index m = 0; m < most; ++m) {
      const double before = m < had ? result.errors[m] : met;
      const double mine = block.errors[std::min(m, block.errors.size() - 1)];
      result.errors[m] = std::max(before, mine);
    }
    lost.segment(s * n, n) = block.lost;
    whole.segment(s * n, n) = block.whole;
    courses.push_back(block.course);
    courses.back().bottomRows(1) = block.lost.transpose();
    result.blocks.push_back(block.separated);
    report(progress, {"separating sites", s + 1.0, static_cast<double>(S),
                      fmt::format("{} modes", result.total_modes())});
  }
  MatrixXd course(result.most_modes(), S * n);
  for (Index s = 0; s < S; ++s) {
    const MatrixXd& here = courses[s];
    for (Index i = 0; i < course.rows(); ++i) {
      course.block(i, s * n, 1, n) = here.row(std::min(i, here.rows() - 1));
    }
  }
  set_errors(lost, whole, std::move(course), result);
  return result;
}

}  // namespace

double default_tolerance(ReductionMethod method) {
  return method == ReductionMethod::kPerSite ? 1e-4 : 1e-3;
}

std::string_view method_name(ReductionMethod method) {
  return std::find_if(kNames.begin(), kNames.end(),
                      [&](const auto& entry) { return entry.first == method; })
      ->second;
}

std::optional<ReductionMethod> method_named(std::string_view name) {
  for (const auto& [method, own_name] : kNames) {
    if (own_name == name) return method;
  }
  return std::nullopt;
}

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const auto& entry : kNames) names.emplace_back(entry.second);
  return names;
}

int Reduction::most_modes() const {
  Index most = 0;
  for (const SeparatedTensor& block : blocks) most = std::max(most, block.F.cols());
  return static_cast<int>(most);
}

int Reduction::total_modes() const {
  Index total = 0;
  for (const SeparatedTensor& block : blocks) total += block.F.cols();
  return static_cast<int>(total);
}

Reduction reduce(const SnapshotRows& snapshots, const VectorXd& weights,
                 const ReductionSettings& settings, const Progress& progress) {
  PALPABLE_EXPECT(!snapshots.sizes.empty(), "a tensor has at least one parameter");
  PALPABLE_EXPECT(weights.size() == snapshots.values && snapshots.values > 0,
                  "one weight per value");
  PALPABLE_EXPECT(weights.minCoeff() > 0.0, "weights are positive");
  PALPABLE_EXPECT(settings.tolerance >= 1e-6 && settings.tolerance < 1.0,
                  "a tolerance below 1e-6 is lost in the Gram matrix");
  PALPABLE_EXPECT(settings.max_modes >= 1, "at least one mode");
  if (settings.method == ReductionMethod::kPerSite) {
    return reduce_per_site(snapshots, weights, settings, progress);
  }
  Reduction result;
  Block block = reduce_to_one(snapshots, weights, settings, progress, result);
  result.errors = std::move(block.errors);
  result.reached = block.reached;
  set_errors(block.lost, block.whole, std::move(block.course), result);
  result.blocks.push_back(std::move(block.separated));
  return result;
}

std::vector<SeparatedTensor> as_blocks(const SeparatedTensor& joint, int n_1,
                                       const VectorXd& weights, double lose) {
  PALPABLE_EXPECT(joint.G.size() == 1 && joint.G[0].rows() % n_1 == 0, "all parameters together");
  const Index n = joint.G[0].rows() / n_1;
  // The weighted norm of F g equals the norm of R g, with R^T R = F^T W F.
  MatrixXd gram = MatrixXd::Zero(joint.F.cols(), joint.F.cols());
  add_gram(weights.cwiseSqrt().asDiagonal() * joint.F, gram);
  const SymmetricEigen eigen = symmetric_eigen(gram);
  const MatrixXd R =
      eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.vectors.transpose();
  std::vector<SeparatedTensor> blocks;
  for (Index k = 0; k < n_1; ++k) {
    const MatrixXd g = joint.G[0].middleRows(k * n, n);  // (n x m)
    const ThinSvd svd = thin_svd(R * g.transpose());
    Index m = svd.s.size();
    double tail = 0;
    while (m > 1 && tail + svd.s[m - 1] * svd.s[m - 1] <= lose * lose * svd.s.squaredNorm()) {
      tail += svd.s[m - 1] * svd.s[m - 1];
      --m;
    }
    const MatrixXd V = svd.V.leftCols(m);
    blocks.push_back({times(joint.F, g.transpose() * V), {V}});
    normalise(blocks.back().F, blocks.back().G[0]);
  }
  return blocks;
}

MatrixXd expand(const Reduction& reduction, const std::vector<int>& sizes) {
  const Index K = snapshot_count(sizes);
  MatrixXd all(reduction.blocks.front().F.rows(), K);
  const Index n = K / static_cast<Index>(reduction.blocks.size());
  for (std::size_t b = 0; b < reduction.blocks.size(); ++b) {
    all.middleCols(static_cast<Index>(b) * n, n) = expand(reduction.blocks[b]);
  }
  return all;
}

}  // namespace palpable
