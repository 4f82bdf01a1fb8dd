/// @file
/// Tables of snapshots over several parameters, and sums of separated modes that approximate them.
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

/// The same table when it need not fit into memory: it is read in blocks of rows, or in blocks of
/// the snapshots of one sample of the first parameter.
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

/// A method stops when it has reached the tolerance or the number of modes.
struct ReductionGoal {
  double tolerance = 1e-3;  ///< relative error |A - A_m| / |A| over all snapshots together
  int max_modes = 300;
};

/// The result of a method; errors are in the plain (Euclidean) norm of the tensor's values.
struct Separation {
  SeparatedTensor separated;
  /// (m) relative error after 1, 2, ... modes. With methods that update all functions, the modes of
  /// a reduction that stops at i modes are not the first i modes of a longer one.
  Eigen::VectorXd errors;
  bool reached = false;  ///< the tolerance, before max_modes
  /// (m x K) squared norm of each snapshot's residual after 1, 2, ... modes. Empty with methods for
  /// which the first i modes are those of a reduction that stops at i.
  Eigen::MatrixXd left = {};
};

/// K
[[nodiscard]] Eigen::Index snapshot_count(const std::vector<int>& sizes);

/// (K x m) column i is the Kronecker product of G_i^1 ... G_i^p, in the order of the snapshots. The
/// function of parameter `skip` is replaced by 1: that gives the coefficients of the least squares
/// problem for this function.
[[nodiscard]] Eigen::MatrixXd parameter_products(const std::vector<Eigen::MatrixXd>& G,
                                                 const std::vector<int>& sizes,
                                                 Eigen::Index skip = -1);

/// (n_j x m) sums of T (K x m) over all parameters but j.
[[nodiscard]] Eigen::MatrixXd sums_over_others(const Eigen::MatrixXd& T,
                                               const std::vector<int>& sizes, std::size_t j);

/// Scales the columns of G to unit length with their largest value positive, and multiplies the
/// columns of F by the factors that were divided out.
void normalise(Eigen::MatrixXd& F, Eigen::MatrixXd& G);

/// (N x K) the snapshots as the modes reproduce them.
[[nodiscard]] Eigen::MatrixXd expand(const SeparatedTensor& separated);

/// Gives access to a table in memory in the form of a table that is read. @param snapshots  must
/// outlive the returned value
[[nodiscard]] SnapshotRows rows_of(const SnapshotTensor& snapshots);

/// Calls visit(first, rows) for all rows in order, in blocks of up to 200 MB.
void for_blocks(const SnapshotRows& snapshots,
                const std::function<void(Eigen::Index first, const Eigen::MatrixXd& rows)>& visit);

}  // namespace palpable
