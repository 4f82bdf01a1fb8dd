#include "palpable/bake/separate/snapshot_tensor.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;

Index snapshot_count(const std::vector<int>& sizes) {
  Index K = 1;
  for (const int n : sizes) K *= n;
  return K;
}

MatrixXd parameter_products(const std::vector<MatrixXd>& G, const std::vector<int>& sizes,
                            Index skip) {
  const Index m = G.front().cols();
  MatrixXd table = MatrixXd::Ones(1, m);
  for (std::size_t j = 0; j < sizes.size(); ++j) {
    MatrixXd longer(table.rows() * sizes[j], m);
    for (Index row = 0; row < table.rows(); ++row) {
      for (Index k = 0; k < sizes[j]; ++k) {
        longer.row(row * sizes[j] + k) = table.row(row);
        if (static_cast<Index>(j) != skip)
          longer.row(row * sizes[j] + k).array() *= G[j].row(k).array();
      }
    }
    table = std::move(longer);
  }
  return table;
}

MatrixXd sums_over_others(const MatrixXd& T, const std::vector<int>& sizes, std::size_t j) {
  Index after = 1;
  for (std::size_t l = j + 1; l < sizes.size(); ++l) after *= sizes[l];
  const Index n = sizes[j], before = T.rows() / (n * after);
  MatrixXd sums = MatrixXd::Zero(n, T.cols());
  for (Index b = 0; b < before; ++b) {
    for (Index k = 0; k < n; ++k) {
      sums.row(k) += T.middleRows((b * n + k) * after, after).colwise().sum();
    }
  }
  return sums;
}

void normalise(MatrixXd& F, MatrixXd& G) {
  for (Index i = 0; i < G.cols(); ++i) {
    Index largest = 0;
    G.col(i).cwiseAbs().maxCoeff(&largest);
    const double size = std::copysign(G.col(i).norm(), G(largest, i));
    if (size == 0.0) continue;
    G.col(i) /= size;
    F.col(i) *= size;
  }
}

MatrixXd expand(const SeparatedTensor& separated) {
  std::vector<int> sizes;
  for (const MatrixXd& functions : separated.G) sizes.push_back(static_cast<int>(functions.rows()));
  return separated.F * parameter_products(separated.G, sizes).transpose();
}

SnapshotRows rows_of(const SnapshotTensor& snapshots) {
  PALPABLE_EXPECT(!snapshots.sizes.empty(), "a tensor has at least one parameter");
  for (const int n : snapshots.sizes) PALPABLE_EXPECT(n >= 1, "a parameter has samples");
  PALPABLE_EXPECT(snapshots.values.cols() == snapshot_count(snapshots.sizes),
                  "one column per snapshot");
  return {snapshots.values.rows(), snapshots.sizes,
          [&](Index first, Index count) { return snapshots.values.middleRows(first, count); },
          [&](int k) {
            const Index n = snapshots.values.cols() / snapshots.sizes[0];
            return snapshots.values.middleCols(k * n, n);
          }};
}

void for_blocks(const SnapshotRows& snapshots,
                const std::function<void(Index first, const MatrixXd& rows)>& visit) {
  constexpr Index kBlockValues = 25'000'000;  // 200 MB of doubles
  const Index K = snapshot_count(snapshots.sizes);
  const Index block = std::max<Index>(1, kBlockValues / K);
  for (Index first = 0; first < snapshots.values; first += block) {
    const Index count = std::min(block, snapshots.values - first);
    const MatrixXd rows = snapshots.read(first, count);
    PALPABLE_EXPECT(rows.rows() == count && rows.cols() == K, "the rows that were asked for");
    visit(first, rows);
  }
}

}  // namespace palpable
