#include "palpable/bake/separate/site_bases.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/bake/separate/pod.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

}  // namespace

MatrixXd SiteBases::combine(const MatrixXd& combination, const VectorXd& weights) const {
  const Index R = static_cast<Index>(columns.size()) / N;
  MatrixXd own(R, combination.cols());
  Index row = 0, first = 0;
  for (const MatrixXd& coordinates : C) {
    own.middleRows(row, coordinates.rows()) =
        coordinates * combination.middleRows(first, coordinates.cols());
    row += coordinates.rows();
    first += coordinates.cols();
  }
  MatrixXd F = times(Eigen::Map<const MatrixXd>(columns.data(), N, R), own);
  F.array().colwise() /= weights.array().sqrt();
  return F;
}

SiteBases site_bases(const SnapshotRows& snapshots, const VectorXd& weights, double lose) {
  const Index K = snapshot_count(snapshots.sizes), n = K / snapshots.sizes[0];
  const VectorXd root = weights.cwiseSqrt();
  SiteBases bases{.N = snapshots.values, .columns = {}, .C = {}, .gram = MatrixXd::Zero(K, K)};
  for (int s = 0; s < snapshots.sizes[0]; ++s) {
    MatrixXd A = snapshots.read_first(s);
    PALPABLE_EXPECT(A.rows() == bases.N && A.cols() == n, "the snapshots that were asked for");
    if (!A.allFinite()) throw Error("a snapshot holds values that are not numbers");
    A.array().colwise() *= root.array();
    MatrixXd gram = MatrixXd::Zero(n, n);
    add_gram(A, gram);
    bases.gram.block(s * n, s * n, n, n) = gram;
    if (gram.diagonal().isZero(0.0)) {
      bases.C.emplace_back(0, n);
      continue;
    }
    const VectorXd norms = gram.diagonal().cwiseSqrt();
    const VectorXd scale = (norms.array() > 0.0).select(norms, 1.0);
    const PodCoordinates Q = pod_coordinates(gram, scale, lose);
    const MatrixXd basis = times(A, Q.combination);
    bases.columns.insert(bases.columns.end(), basis.data(), basis.data() + basis.size());
    bases.C.emplace_back(Q.C * scale.asDiagonal());
  }
  const Index R = static_cast<Index>(bases.columns.size()) / bases.N;
  MatrixXd products = MatrixXd::Zero(R, R);
  add_gram(Eigen::Map<const MatrixXd>(bases.columns.data(), bases.N, R), products);
  Index row = 0;
  for (std::size_t s = 0; s < bases.C.size(); ++s) {
    Index column = 0;
    for (std::size_t t = 0; t < s; ++t) {
      bases.gram.block(static_cast<Index>(s) * n, static_cast<Index>(t) * n, n, n) =
          bases.C[s].transpose() *
          products.block(row, column, bases.C[s].rows(), bases.C[t].rows()) * bases.C[t];
      column += bases.C[t].rows();
    }
    row += bases.C[s].rows();
  }
  return bases;
}

}  // namespace palpable
