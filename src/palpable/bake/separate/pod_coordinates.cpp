#include "palpable/bake/separate/pod_coordinates.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <algorithm>
#include <cmath>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

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
