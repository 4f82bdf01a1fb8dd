#include "palpable/bake/separate/hosvd.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// A tensor (R x n_1 ... n_p) whose sizes change as directions are truncated.
struct Table {
  MatrixXd values;         // (R x K)
  std::vector<int> sizes;  // (p)

  // The products of the sizes before and after parameter j: K = before * n_j * after.
  [[nodiscard]] std::pair<Index, Index> around(std::size_t j) const {
    Index before = 1, after = 1;
    for (std::size_t l = 0; l < j; ++l) before *= sizes[l];
    for (std::size_t l = j + 1; l < sizes.size(); ++l) after *= sizes[l];
    return {before, after};
  }
};

// (R before after x n_j) all fibres along parameter j, as rows.
MatrixXd unfold(const Table& table, std::size_t j) {
  const auto [before, after] = table.around(j);
  const Index n = table.sizes[j], R = table.values.rows();
  MatrixXd fibres(R * before * after, n);
  for (Index b = 0; b < before; ++b) {
    for (Index k = 0; k < n; ++k) {
      for (Index a = 0; a < after; ++a) {
        fibres.col(k).segment((b * after + a) * R, R) = table.values.col((b * n + k) * after + a);
      }
    }
  }
  return fibres;
}

Table fold(const MatrixXd& fibres, Table table, std::size_t j) {
  const auto [before, after] = table.around(j);
  const Index n = fibres.cols(), R = table.values.rows();
  table.sizes[j] = static_cast<int>(n);
  table.values.resize(R, before * n * after);
  for (Index b = 0; b < before; ++b) {
    for (Index k = 0; k < n; ++k) {
      for (Index a = 0; a < after; ++a) {
        table.values.col((b * n + k) * after + a) = fibres.col(k).segment((b * after + a) * R, R);
      }
    }
  }
  return table;
}

// The smallest number of leading columns of V for which the norm of the singular values that are
// cut off is at most `allowed`. Adds the square of that norm to `lost_squared`.
MatrixXd cut(const MatrixXd& V, const Eigen::VectorXd& s, double allowed, double& lost_squared) {
  Index rank = s.size();
  double tail = 0;
  while (rank > 1 && tail + s[rank - 1] * s[rank - 1] <= allowed * allowed) {
    tail += s[rank - 1] * s[rank - 1];
    --rank;
  }
  lost_squared += tail;
  return V.leftCols(rank);
}

}  // namespace

std::vector<int> Tucker::ranks() const {
  std::vector<int> ranks;
  for (const MatrixXd& basis : U) ranks.push_back(static_cast<int>(basis.cols()));
  return ranks;
}

Tucker hosvd(const SnapshotTensor& snapshots, double tolerance, HosvdOrder order) {
  PALPABLE_EXPECT(tolerance > 0.0, "a tolerance above zero");
  PALPABLE_EXPECT(snapshots.values.cols() == snapshot_count(snapshots.sizes),
                  "one column per snapshot");
  const double whole = snapshots.values.norm();
  if (!(whole > 0.0)) throw Error("all snapshots are zero: there is nothing to reduce");
  const std::size_t p = snapshots.sizes.size();
  const double allowed = tolerance * whole / std::sqrt(static_cast<double>(1 + p));
  const Table tensor{snapshots.values, snapshots.sizes};
  double lost_squared = 0;
  Tucker tucker;
  const ThinSvd space = thin_svd(tensor.values);
  tucker.U.push_back(cut(space.U, space.s, allowed, lost_squared));
  Table core{transposed_times(tucker.U[0], tensor.values), tensor.sizes};
  for (std::size_t j = 0; j < p; ++j) {
    const ThinSvd svd = thin_svd(unfold(order == HosvdOrder::kSequential ? core : tensor, j));
    tucker.U.push_back(cut(svd.V, svd.s, allowed, lost_squared));
    core = fold(times(unfold(core, j), tucker.U.back()), core, j);
  }
  tucker.core = std::move(core.values);
  tucker.bound = std::sqrt(lost_squared) / whole;
  return tucker;
}

SeparatedTensor as_two_factors(const Tucker& tucker) {
  Table table{tucker.core, {}};
  for (std::size_t j = 1; j < tucker.U.size(); ++j) {
    table.sizes.push_back(static_cast<int>(tucker.U[j].cols()));
  }
  for (std::size_t j = 0; j < table.sizes.size(); ++j) {
    table = fold(times(unfold(table, j), tucker.U[j + 1].transpose()), table, j);
  }
  SeparatedTensor separated{tucker.U[0], {table.values.transpose()}};
  normalise(separated.F, separated.G[0]);
  return separated;
}

MatrixXd expand(const Tucker& tucker) { return expand(as_two_factors(tucker)); }

}  // namespace palpable
