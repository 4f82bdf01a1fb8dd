#include "palpable/bake/separate/pod.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd random_matrix(Index rows, Index columns, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  MatrixXd A(rows, columns);
  for (double& x : A.reshaped()) x = normal(random);
  return A;
}

}  // namespace

Separation pod(const SnapshotTensor& snapshots, const ReductionGoal& goal) {
  PALPABLE_EXPECT(goal.max_modes >= 1 && goal.tolerance > 0.0, "a goal that ends");
  const ThinSvd svd = thin_svd(snapshots.values);
  const double whole = svd.s.norm();
  if (!(whole > 0.0)) throw Error("all snapshots are zero: there is nothing to reduce");
  // Summed from the smallest value upwards, so that rounding does not lose the small ones.
  VectorXd errors(svd.s.size());
  double tail = 0;
  for (Index m = svd.s.size(); m-- > 0;) {
    errors[m] = std::sqrt(tail) / whole;
    tail += svd.s[m] * svd.s[m];
  }
  Index m = 1;
  while (m < errors.size() && m < goal.max_modes && errors[m - 1] > goal.tolerance) ++m;
  Separation result{{svd.U.leftCols(m) * svd.s.head(m).asDiagonal(), {svd.V.leftCols(m)}},
                    errors.head(m),
                    errors[m - 1] <= goal.tolerance};
  normalise(result.separated.F, result.separated.G[0]);
  return result;
}

RandomisedPod randomised_pod(const SnapshotRows& snapshots, const VectorXd& weights,
                             const RandomisedPodSettings& settings) {
  PALPABLE_EXPECT(settings.rank >= 1 && settings.oversampling >= 0, "directions to look along");
  PALPABLE_EXPECT(settings.passes == 1 || settings.passes == 2, "one pass or two");
  PALPABLE_EXPECT(weights.size() == snapshots.values && weights.minCoeff() > 0.0,
                  "a positive weight for each value");
  const Index N = snapshots.values, K = snapshot_count(snapshots.sizes);
  const Index l = std::min({Index{settings.rank} + settings.oversampling, N, K});
  const Index rank = std::min<Index>(settings.rank, l);
  const VectorXd root = weights.cwiseSqrt();
  // (2 l x count) Columns of Psi, generated again whenever they are needed: stored, Psi would take
  // twice the memory of the basis.
  const Index tests = std::min(2 * l, N);
  const auto Psi = [&](Index first, Index count) {
    return random_matrix(tests, count, settings.seed + 1 + static_cast<std::uint64_t>(first));
  };
  const MatrixXd Omega = random_matrix(K, l, settings.seed);
  MatrixXd Y(N, l), W = MatrixXd::Zero(settings.passes == 1 ? tests : 0, K);
  std::vector<std::pair<Index, Index>> blocks;
  for_blocks(snapshots, [&](Index first, const MatrixXd& A) {
    if (!A.allFinite()) throw Error("a snapshot holds values that are not numbers");
    const MatrixXd weighted = root.segment(first, A.rows()).asDiagonal() * A;
    Y.middleRows(first, A.rows()) = times(weighted, Omega);
    if (settings.passes == 1) W += times(Psi(first, A.rows()), weighted);
    blocks.emplace_back(first, A.rows());
  });
  const MatrixXd Q = orthonormal_basis(Y);
  MatrixXd B = MatrixXd::Zero(l, K);
  if (settings.passes == 2) {
    for_blocks(snapshots, [&](Index first, const MatrixXd& A) {
      const MatrixXd weighted = root.segment(first, A.rows()).asDiagonal() * A;
      B += transposed_times(Q.middleRows(first, A.rows()), weighted);
    });
  } else {
    MatrixXd Psi_Q = MatrixXd::Zero(tests, l);
    for (const auto& [first, count] : blocks) {
      Psi_Q += times(Psi(first, count), Q.middleRows(first, count));
    }
    // The pseudo-inverse of Psi Q, which is well conditioned: it has twice as many rows as columns.
    const ThinSvd tested = thin_svd(Psi_Q);
    const VectorXd inverse = (tested.s.array() > 1e-12 * tested.s[0])
                                 .select(tested.s.cwiseInverse(), VectorXd::Zero(tested.s.size()));
    B = tested.V * (inverse.asDiagonal() * transposed_times(tested.U, W));
  }
  const ThinSvd svd = thin_svd(B);
  return {root.cwiseInverse().asDiagonal() * times(Q, svd.U.leftCols(rank)),
          svd.s.head(rank).asDiagonal() * svd.V.leftCols(rank).transpose()};
}

MatrixXd gram_of(const SnapshotRows& snapshots, const VectorXd& weights) {
  const Index K = snapshot_count(snapshots.sizes);
  MatrixXd gram = MatrixXd::Zero(K, K);
  for_blocks(snapshots, [&](Index first, const MatrixXd& A) {
    if (!A.allFinite()) throw Error("a snapshot holds values that are not numbers");
    add_gram(weights.segment(first, A.rows()).cwiseSqrt().asDiagonal() * A, gram);
  });
  return gram;
}

PodCoordinates pod_coordinates(const MatrixXd& gram, const VectorXd& scale, double lose) {
  PALPABLE_EXPECT(scale.size() == gram.rows() && scale.minCoeff() > 0.0, "a scale per snapshot");
  if (gram.diagonal().isZero(0.0)) {
    throw Error("all snapshots are zero: there is nothing to reduce");
  }
  const VectorXd inverse = scale.cwiseInverse();
  const SymmetricEigen eigen = symmetric_eigen(inverse.asDiagonal() * gram * inverse.asDiagonal());
  const VectorXd squares = eigen.values.reverse().cwiseMax(0.0);
  const double whole = squares.sum();
  Index r = squares.size();
  double tail = 0;
  while (r > 1 &&
         (squares[r - 1] <= 1e-14 * squares[0] || tail + squares[r - 1] <= lose * lose * whole)) {
    tail += squares[r - 1];
    --r;
  }
  const VectorXd S = squares.head(r).cwiseSqrt();
  const MatrixXd V = eigen.vectors.rightCols(r).rowwise().reverse();
  return {S.asDiagonal() * V.transpose(), inverse.asDiagonal() * V * S.cwiseInverse().asDiagonal(),
          std::sqrt(tail / whole)};
}

std::vector<VectorXd> separated_norms(const VectorXd& norms, const std::vector<int>& sizes) {
  PALPABLE_EXPECT(norms.size() == snapshot_count(sizes), "a norm per snapshot");
  const MatrixXd logarithms =
      (norms.array() > 0.0).select(norms.array().max(1e-300).log(), 0.0).matrix();
  const double mean = logarithms.mean();
  std::vector<VectorXd> factors;
  for (std::size_t j = 0; j < sizes.size(); ++j) {
    const double samples = static_cast<double>(norms.size()) / sizes[j];
    VectorXd own = sums_over_others(logarithms, sizes, j).col(0) / samples;
    if (j > 0) own.array() -= mean;
    factors.emplace_back(own.array().exp());
  }
  return factors;
}

}  // namespace palpable
