#include "palpable/bake/separate/alternating_least_squares.h"

#include "palpable/bake/separate/dense_algebra.h"

#include <Eigen/Cholesky>

#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// The x that minimises |B - x A^T|, from B A and A^T A.
MatrixXd least_squares(const MatrixXd& BA, MatrixXd AtA) {
  AtA.diagonal().array() += 1e-13 * AtA.trace() / static_cast<double>(AtA.rows());
  return AtA.ldlt().solve(BA.transpose()).transpose();
}

}  // namespace

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

}  // namespace palpable
