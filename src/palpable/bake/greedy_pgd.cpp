#include "palpable/bake/greedy_pgd.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Functions G of all modes (or of one: m = 1).
using Functions = std::vector<MatrixXd>;

Index product(const std::vector<int>& sizes) {
  Index K = 1;
  for (const int n : sizes) K *= n;
  return K;
}

// (K x m) column i is G_i^1 (x) ... (x) G_i^p in the order of the snapshots; `skip` leaves one
// parameter's function out (as if it were 1), which makes the least squares problem for it.
MatrixXd products(const Functions& G, const std::vector<int>& sizes, Index skip = -1) {
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

// (n_j x m) sums of T (K x m) over all parameters but j.
MatrixXd sum_over_others(const MatrixXd& T, const std::vector<int>& sizes, std::size_t j) {
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

// x of min |B - x A^T| given B A and A^T A. The ridge keeps nearly parallel modes from growing
// against each other; a step that it spoils is refused by the caller.
MatrixXd least_squares(const MatrixXd& BA, MatrixXd AtA) {
  AtA.diagonal().array() += 1e-13 * AtA.trace() / static_cast<double>(AtA.rows());
  return AtA.ldlt().solve(BA.transpose()).transpose();
}

// Unit columns, the largest value positive; the size goes into F.
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

// The greedy sweep itself, in whatever orthonormal coordinates the columns of C are given.
class Greedy {
 public:
  Greedy(const MatrixXd& C, const std::vector<int>& sizes, const GreedySettings& settings)
      : C_(C), sizes_(sizes), settings_(settings), R_(C), norm_(C.norm()) {
    F_.resize(C.rows(), 0);
    for (const int n : sizes) G_.emplace_back(n, 0);
  }

  void add_mode() {
    auto [f, g] = best_rank_one();
    const Index m = F_.cols();
    R_.noalias() -= f * products(g, sizes_).transpose();
    F_.conservativeResize(Eigen::NoChange, m + 1);
    F_.col(m) = f;
    for (std::size_t j = 0; j < G_.size(); ++j) {
      G_[j].conservativeResize(Eigen::NoChange, m + 1);
      G_[j].col(m) = g[j];
    }
    if (settings_.update_all && m > 0) update_all();
  }

  [[nodiscard]] double error() const { return R_.norm() / norm_; }
  [[nodiscard]] const MatrixXd& F() const { return F_; }
  [[nodiscard]] const Functions& G() const { return G_; }

 private:
  std::pair<MatrixXd, Functions> best_rank_one() const {
    Index largest = 0;
    R_.colwise().squaredNorm().maxCoeff(&largest);
    MatrixXd f = R_.col(largest).normalized();
    Functions g(sizes_.size());
    for (std::size_t j = sizes_.size(); j-- > 0;) {
      g[j] = VectorXd::Unit(sizes_[j], largest % sizes_[j]);
      largest /= sizes_[j];
    }
    double size = 0;
    for (int pass = 0; pass < settings_.max_passes; ++pass) {
      const VectorXd t = R_.transpose() * f;
      for (std::size_t j = 0; j < g.size(); ++j) {
        const MatrixXd others = products(g, sizes_, static_cast<Index>(j));
        g[j] = sum_over_others(t.cwiseProduct(others.col(0)), sizes_, j);
        const double length = g[j].norm();
        if (length == 0.0) break;  // R is zero: nothing to find
        g[j] /= length;
      }
      f = R_ * products(g, sizes_);
      const double new_size = f.norm();
      const bool settled = std::abs(new_size - size) <= settings_.pass_tolerance * new_size;
      size = new_size;
      if (settled || size == 0.0) break;
      f /= size;
    }
    f *= size / std::max(f.norm(), 1e-300);
    for (MatrixXd& function : g) normalise(f, function);
    return {std::move(f), std::move(g)};
  }

  // One round of alternating least squares over all modes; kept only if it helps.
  void update_all() {
    MatrixXd F = F_;
    Functions G = G_;
    const MatrixXd T = C_.transpose() * F;  // (K x m), the same for every parameter
    for (std::size_t j = 0; j < G.size(); ++j) {
      MatrixXd gram = F.transpose() * F;
      for (std::size_t l = 0; l < G.size(); ++l) {
        if (l != j) gram.array() *= (G[l].transpose() * G[l]).array();
      }
      const MatrixXd others = products(G, sizes_, static_cast<Index>(j));
      G[j] = least_squares(sum_over_others(T.cwiseProduct(others), sizes_, j), gram);
      for (Index i = 0; i < G[j].cols(); ++i) {
        // The size may go: each least squares answer that follows, F's at last, finds its own.
        const double length = G[j].col(i).norm();
        if (length > 0.0) G[j].col(i) /= length;
      }
    }
    const MatrixXd table = products(G, sizes_);
    F = least_squares(C_ * table, table.transpose() * table);
    for (MatrixXd& functions : G) normalise(F, functions);
    const MatrixXd left = C_ - F * products(G, sizes_).transpose();
    if (!(left.norm() < R_.norm())) return;
    F_ = std::move(F);
    G_ = std::move(G);
    R_ = left;
  }

  const MatrixXd& C_;
  const std::vector<int>& sizes_;
  const GreedySettings& settings_;
  MatrixXd R_;  // C less the modes
  double norm_;
  MatrixXd F_;
  Functions G_;
};

void check_arguments(const std::vector<int>& sizes, Index rows, const VectorXd& weights,
                     const GreedySettings& settings) {
  PALPABLE_EXPECT(!sizes.empty(), "a tensor has at least one parameter");
  for (const int n : sizes) PALPABLE_EXPECT(n >= 1, "a parameter has samples");
  PALPABLE_EXPECT(weights.size() == rows && rows > 0, "one weight per value");
  PALPABLE_EXPECT(weights.minCoeff() > 0.0, "weights are positive");
  PALPABLE_EXPECT(settings.tolerance >= 1e-6, "a tolerance below 1e-6 is lost in the Gram matrix");
  PALPABLE_EXPECT(settings.max_modes >= 1 && settings.max_passes >= 1, "at least one of each");
}

SnapshotRows rows_of(const SnapshotTensor& snapshots) {
  PALPABLE_EXPECT(snapshots.values.cols() == product(snapshots.sizes), "one column per snapshot");
  return {snapshots.values.rows(), snapshots.sizes,
          [&](Index first, Index count) { return snapshots.values.middleRows(first, count); }};
}

// Calls visit(first, rows) for all rows, in blocks that fit into memory.
template <class Visit>
void for_blocks(const SnapshotRows& snapshots, const Visit& visit) {
  constexpr Index kBlockValues = 25'000'000;  // 200 MB of doubles
  const Index K = product(snapshots.sizes);
  const Index block = std::max<Index>(1, kBlockValues / K);
  for (Index first = 0; first < snapshots.values; first += block) {
    const Index count = std::min(block, snapshots.values - first);
    const MatrixXd rows = snapshots.read(first, count);
    PALPABLE_EXPECT(rows.rows() == count && rows.cols() == K, "the rows that were asked for");
    visit(first, rows);
  }
}

// Runs the greedy sweep to its end.
Greedy run(const MatrixXd& C, const std::vector<int>& sizes, const GreedySettings& settings,
           const Progress& progress, GreedyResult& result) {
  Greedy greedy(C, sizes, settings);
  std::vector<double> errors;
  // Done as the error falls from 1 to the tolerance, on a logarithmic scale.
  const double total = -std::log10(settings.tolerance);
  while (static_cast<int>(errors.size()) < settings.max_modes && !result.reached) {
    greedy.add_mode();
    errors.push_back(greedy.error());
    result.reached = errors.back() <= settings.tolerance;
    const double done = std::min(total, -std::log10(std::max(errors.back(), settings.tolerance)));
    report(progress, {"separating", std::max(0.0, done), std::max(total, 1e-9),
                      fmt::format("{} modes, error {:.2g}", errors.size(), errors.back())});
  }
  result.errors = Eigen::Map<const VectorXd>(errors.data(), static_cast<Index>(errors.size()));
  return greedy;
}

// From the squares of what is left of each snapshot and of the whole of it.
void set_errors(const VectorXd& lost, const VectorXd& whole, GreedyResult& result) {
  result.error = std::sqrt(lost.sum() / whole.sum());
  result.snapshot_errors = VectorXd::Zero(lost.size());
  for (Index k = 0; k < lost.size(); ++k) {
    if (whole[k] > 0.0) result.snapshot_errors[k] = std::sqrt(lost[k] / whole[k]);
  }
}

// F = A `combination`, and what is then left of the snapshots.
void finish(const SnapshotRows& snapshots, const VectorXd& weights, const MatrixXd& combination,
            GreedyResult& result) {
  SeparatedTensor& separated = result.separated;
  separated.F.resize(snapshots.values, combination.cols());
  const MatrixXd table = products(separated.G, snapshots.sizes);  // (K x m)
  VectorXd lost = VectorXd::Zero(table.rows()), whole = lost;
  for_blocks(snapshots, [&](Index first, const MatrixXd& A) {
    const auto w = weights.segment(first, A.rows()).array();
    const MatrixXd F = A * combination;
    separated.F.middleRows(first, A.rows()) = F;
    const MatrixXd left = A - F * table.transpose();
    lost += (left.array().square().colwise() * w).colwise().sum().matrix().transpose();
    whole += (A.array().square().colwise() * w).colwise().sum().matrix().transpose();
  });
  set_errors(lost, whole, result);
}

void measure(const SnapshotTensor& snapshots, const VectorXd& weights, GreedyResult& result) {
  const MatrixXd left = snapshots.values - expand(result.separated);
  const VectorXd lost = (left.array().square().colwise() * weights.array()).colwise().sum();
  const VectorXd whole =
      (snapshots.values.array().square().colwise() * weights.array()).colwise().sum();
  set_errors(lost, whole, result);
}

}  // namespace

GreedyResult separate(const SnapshotTensor& snapshots, const VectorXd& weights,
                      const GreedySettings& settings, const Progress& progress) {
  return separate(rows_of(snapshots), weights, settings, progress);
}

GreedyResult separate(const SnapshotRows& snapshots, const VectorXd& weights,
                      const GreedySettings& settings, const Progress& progress) {
  check_arguments(snapshots.sizes, snapshots.values, weights, settings);
  const Index K = product(snapshots.sizes);
  // A^T W A = V S^2 V^T gives C = S V^T, the coordinates in Q = A V S^-1.
  MatrixXd gram = MatrixXd::Zero(K, K);
  report(progress, {"products of snapshots", 0.0, 1.0, ""});
  for_blocks(snapshots, [&](Index first, const MatrixXd& A) {
    if (!A.allFinite()) throw Error("a snapshot holds values that are not numbers");
    const MatrixXd weighted = weights.segment(first, A.rows()).cwiseSqrt().asDiagonal() * A;
    gram.selfadjointView<Eigen::Lower>().rankUpdate(weighted.transpose());
    report(progress, {"products of snapshots", static_cast<double>(first + A.rows()),
                      static_cast<double>(snapshots.values), ""});
  });
  if (gram.diagonal().isZero(0.0)) {
    throw Error("all snapshots are zero: there is nothing to reduce");
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram);
  if (eigen.info() != Eigen::Success) throw Error("the snapshots' Gram matrix has no eigenvalues");
  const VectorXd& squares = eigen.eigenvalues();  // increasing
  Index r = 0;
  while (r < squares.size() &&
         squares[squares.size() - 1 - r] > 1e-14 * squares[squares.size() - 1])
    ++r;
  const VectorXd S = squares.tail(r).cwiseSqrt();
  const MatrixXd V = eigen.eigenvectors().rightCols(r);

  GreedyResult result;
  const MatrixXd C = S.asDiagonal() * V.transpose();
  const Greedy greedy = run(C, snapshots.sizes, settings, progress, result);
  result.separated.G = greedy.G();
  // (K x m)
  finish(snapshots, weights, V * (S.cwiseInverse().asDiagonal() * greedy.F()), result);
  return result;
}

GreedyResult separate_in_full_space(const SnapshotTensor& snapshots, const VectorXd& weights,
                                    const GreedySettings& settings, const Progress& progress) {
  check_arguments(snapshots.sizes, snapshots.values.rows(), weights, settings);
  const VectorXd root = weights.cwiseSqrt();
  GreedyResult result;
  const MatrixXd C = root.asDiagonal() * snapshots.values;
  const Greedy greedy = run(C, snapshots.sizes, settings, progress, result);
  result.separated.G = greedy.G();
  result.separated.F = root.cwiseInverse().asDiagonal() * greedy.F();
  measure(snapshots, weights, result);
  return result;
}

MatrixXd expand(const SeparatedTensor& separated) {
  std::vector<int> sizes;
  for (const MatrixXd& functions : separated.G) sizes.push_back(static_cast<int>(functions.rows()));
  return separated.F * products(separated.G, sizes).transpose();
}

}  // namespace palpable
