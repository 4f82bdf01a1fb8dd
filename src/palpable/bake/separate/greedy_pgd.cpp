#include "palpable/bake/separate/greedy_pgd.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The x that minimises |B - x A^T|, from B A and A^T A.
MatrixXd least_squares(const MatrixXd& BA, MatrixXd AtA) {
  AtA.diagonal().array() += 1e-13 * AtA.trace() / static_cast<double>(AtA.rows());
  return AtA.ldlt().solve(BA.transpose()).transpose();
}

// Replaces each table of functions in turn by the least squares solution for it while all other
// tables are kept; the parameters come first, space last:
//
//     G^j = argmin | A - F o G^1 o ... o G^p |     with the Gram matrix  F^T F * (G^l)^T G^l * ...
//
// (Kolda and Bader 2009, Sec. 3.4). A ridge of 1e-13, relative to the mean diagonal of the Gram
// matrix, prevents nearly parallel modes from growing against each other.
// @param left  (N x K) the residual, A minus the modes; updated when the round lowers its norm
// @return whether the round lowered the residual; if not, `separated` and `left` are unchanged
bool improve_all_functions(const SnapshotTensor& A, SeparatedTensor& separated, MatrixXd& left) {
  MatrixXd F = separated.F;
  std::vector<MatrixXd> G = separated.G;
  const MatrixXd T = transposed_times(A.values, F);  // (K x m), the same for every parameter
  for (std::size_t j = 0; j < G.size(); ++j) {
    MatrixXd gram = F.transpose() * F;
    for (std::size_t l = 0; l < G.size(); ++l) {
      if (l != j) gram.array() *= (G[l].transpose() * G[l]).array();
    }
    const MatrixXd others = parameter_products(G, A.sizes, static_cast<Index>(j));
    G[j] = least_squares(sums_over_others(T.cwiseProduct(others), A.sizes, j), gram);
    for (Index i = 0; i < G[j].cols(); ++i) {
      // The length can be dropped: the least squares solutions after this one, the last of them for
      // F, determine their own scale.
      const double length = G[j].col(i).norm();
      if (length > 0.0) G[j].col(i) /= length;
    }
  }
  const MatrixXd table = parameter_products(G, A.sizes);
  F = least_squares(times(A.values, table), table.transpose() * table);
  for (MatrixXd& functions : G) normalise(F, functions);
  MatrixXd now_left = A.values;
  subtract_product(F, parameter_products(G, A.sizes), now_left);
  if (!(now_left.norm() < left.norm())) return false;
  separated.F = std::move(F);
  separated.G = std::move(G);
  left = std::move(now_left);
  return true;
}

}  // namespace

GreedyPgd::GreedyPgd(const SnapshotTensor& snapshots, const GreedySettings& settings)
    : snapshots_(snapshots),
      settings_(settings),
      left_(snapshots.values),
      norm_(snapshots.values.norm()) {
  PALPABLE_EXPECT(!snapshots.sizes.empty(), "a tensor has at least one parameter");
  PALPABLE_EXPECT(snapshots.values.cols() == snapshot_count(snapshots.sizes),
                  "one column per snapshot");
  PALPABLE_EXPECT(settings.max_passes >= 1, "at least one pass");
  if (!(norm_ > 0.0)) throw Error("all snapshots are zero: there is nothing to reduce");
  separated_.F.resize(snapshots.values.rows(), 0);
  for (const int n : snapshots.sizes) separated_.G.emplace_back(n, 0);
}

void GreedyPgd::add_mode() {
  const SeparatedTensor mode = best_rank_one();
  const Index m = separated_.F.cols();
  left_.noalias() -= mode.F * parameter_products(mode.G, snapshots_.sizes).transpose();
  separated_.F.conservativeResize(Eigen::NoChange, m + 1);
  separated_.F.col(m) = mode.F;
  for (std::size_t j = 0; j < mode.G.size(); ++j) {
    separated_.G[j].conservativeResize(Eigen::NoChange, m + 1);
    separated_.G[j].col(m) = mode.G[j];
  }
  if (settings_.update_all && m > 0) improve();
}

bool GreedyPgd::improve() { return improve_all_functions(snapshots_, separated_, left_); }

SeparatedTensor GreedyPgd::best_rank_one() const {
  const std::vector<int>& sizes = snapshots_.sizes;
  Index largest = 0;
  left_.colwise().squaredNorm().maxCoeff(&largest);
  SeparatedTensor mode{left_.col(largest).normalized(), std::vector<MatrixXd>(sizes.size())};
  auto& [f, g] = mode;
  for (std::size_t j = sizes.size(); j-- > 0;) {
    g[j] = VectorXd::Unit(sizes[j], largest % sizes[j]);
    largest /= sizes[j];
  }
  double size = 0;
  for (int pass = 0; pass < settings_.max_passes; ++pass) {
    const VectorXd t = left_.transpose() * f;
    for (std::size_t j = 0; j < g.size(); ++j) {
      const MatrixXd others = parameter_products(g, sizes, static_cast<Index>(j));
      g[j] = sums_over_others(t.cwiseProduct(others.col(0)), sizes, j);
      const double length = g[j].norm();
      if (length == 0.0) break;  // the residual has no part along these functions
      g[j] /= length;
    }
    f = left_ * parameter_products(g, sizes);
    const double new_size = f.norm();
    const bool settled = std::abs(new_size - size) <= settings_.pass_tolerance * new_size;
    size = new_size;
    if (settled || size == 0.0) break;
    f /= size;
  }
  f *= size / std::max(f.norm(), 1e-300);
  for (MatrixXd& function : g) normalise(f, function);
  return mode;
}

Separation greedy_pgd(const SnapshotTensor& snapshots, const ReductionGoal& goal,
                      const GreedySettings& settings, const Progress& progress) {
  PALPABLE_EXPECT(goal.max_modes >= 1 && goal.tolerance > 0.0, "a goal that ends");
  GreedyPgd greedy(snapshots, settings);
  Separation result;
  std::vector<double> errors;
  std::vector<VectorXd> left;
  // Progress is measured by the decades by which the error has fallen from 1 towards the tolerance.
  const double total = -std::log10(goal.tolerance);
  while (static_cast<int>(errors.size()) < goal.max_modes && !result.reached) {
    greedy.add_mode();
    errors.push_back(greedy.error());
    left.push_back(greedy.left());
    result.reached = errors.back() <= goal.tolerance;
    const double done = std::min(total, -std::log10(std::max(errors.back(), goal.tolerance)));
    report(progress, {"separating", std::max(0.0, done), std::max(total, 1e-9),
                      fmt::format("{} modes, error {:.2g}", errors.size(), errors.back())});
  }
  result.errors = Eigen::Map<const VectorXd>(errors.data(), static_cast<Index>(errors.size()));
  result.left.resize(result.errors.size(), snapshots.values.cols());
  for (Index i = 0; i < result.left.rows(); ++i) { result.left.row(i) = left[i].transpose(); }
  result.separated = greedy.separated();
  return result;
}

}  // namespace palpable
