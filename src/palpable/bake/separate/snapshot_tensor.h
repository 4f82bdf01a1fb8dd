/// @file
/// Tables of snapshots over several parameters, and sums of separated modes that stand for them.
///
/// Letters used for shapes in this file and in those of the methods:
///   N    values in one snapshot (3 or 6 per node; or coordinates in a basis)
///   p    parameters       n_j  samples of parameter j
///   K    snapshots, n_1 n_2 ... n_p; the last parameter runs fastest: k = (k_1 n_2 + k_2) n_3 ...
///   m    modes
#pragma once

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace palpable {

/// Fields over all combinations of p parameters' samples.
struct SnapshotTensor {
  Eigen::MatrixXd values;  ///< (N x K)
  std::vector<int> sizes;  ///< (p) n_j, each >= 1
};

/// The same table where it need not fit into memory: read in blocks of rows, or the snapshots of
/// one sample of the first parameter at a time.
struct SnapshotRows {
  Eigen::Index values = 0;  ///< N
  std::vector<int> sizes;   ///< (p) n_j
  /// (count x K) rows first .. first + count - 1
  std::function<Eigen::MatrixXd(Eigen::Index first, Eigen::Index count)> read;
  /// (N x K / n_1) all rows of the snapshots whose first parameter has its sample k_1
  std::function<Eigen::MatrixXd(int k_1)> read_first;
};

/// u(X, mu) ~= sum_i F_i(X) G_i^1(mu_1) ... G_i^p(mu_p) on the samples.
struct SeparatedTensor {
  Eigen::MatrixXd F;               ///< (N x m) column i is F_i, in the unit of the field
  std::vector<Eigen::MatrixXd> G;  ///< (p) of (n_j x m), columns of unit length
};

/// When a method may stop.
struct ReductionGoal {
  double tolerance = 1e-3;  ///< relative error |A - A_m| / |A|, all snapshots pooled
  int max_modes = 300;      ///< or at this many modes
};

/// What a method makes of a tensor, in the plain (Euclidean) norm of its values.
struct Separation {
  SeparatedTensor separated;
  /// (m) relative error after 1, 2, ... modes. Where functions are updated, those of a reduction
  /// stopped at i modes are not the first i of a longer one.
  Eigen::VectorXd errors;
  bool reached = false;  ///< the tolerance, before max_modes
  /// (m x K) squares of what is left of each snapshot after 1, 2, ... modes. Empty where the first
  /// i modes are what a reduction stopped at i would have found.
  Eigen::MatrixXd left = {};
};

/// K
[[nodiscard]] Eigen::Index snapshot_count(const std::vector<int>& sizes);

/// (K x m) column i is G_i^1 (x) ... (x) G_i^p in the order of the snapshots; `skip` leaves one
/// parameter's function out (as if it were 1), which makes the least squares problem for it.
[[nodiscard]] Eigen::MatrixXd parameter_products(const std::vector<Eigen::MatrixXd>& G,
                                                 const std::vector<int>& sizes,
                                                 Eigen::Index skip = -1);

/// (n_j x m) sums of T (K x m) over all parameters but j.
[[nodiscard]] Eigen::MatrixXd sums_over_others(const Eigen::MatrixXd& T,
                                               const std::vector<int>& sizes, std::size_t j);

/// Unit columns of G, the largest value positive; the size goes into F.
void normalise(Eigen::MatrixXd& F, Eigen::MatrixXd& G);

/// (N x K) what the modes say the snapshots are.
[[nodiscard]] Eigen::MatrixXd expand(const SeparatedTensor& separated);

/// A table in memory, as one that is read. @param snapshots  outlives the answer
[[nodiscard]] SnapshotRows rows_of(const SnapshotTensor& snapshots);

/// Calls visit(first, rows) for all rows in turn, in blocks of up to 200 MB.
void for_blocks(const SnapshotRows& snapshots,
                const std::function<void(Eigen::Index first, const Eigen::MatrixXd& rows)>& visit);

}  // namespace palpable
