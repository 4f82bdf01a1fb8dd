/// @file
/// Non-intrusive PGD: a table of snapshots as a short sum of separated modes (paper Sec. 3.2).
///
/// Letters used for shapes in this file:
///   N    values in one snapshot (3 or 6 per node)
///   p    parameters       n_j  samples of parameter j
///   K    snapshots, n_1 n_2 ... n_p
///   m    modes
#pragma once

#include "palpable/base/progress.h"

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace palpable {

/// Fields over all combinations of p parameters' samples.
struct SnapshotTensor {
  Eigen::MatrixXd values;  ///< (N x K) the last parameter runs fastest: k = (k_1 n_2 + k_2) n_3 ...
  std::vector<int> sizes;  ///< (p) n_j, each >= 1
};

/// The same table where it need not fit into memory: read in blocks of rows.
struct SnapshotRows {
  Eigen::Index values = 0;  ///< N
  std::vector<int> sizes;   ///< (p) n_j
  /// (count x K) rows first .. first + count - 1
  std::function<Eigen::MatrixXd(Eigen::Index first, Eigen::Index count)> read;
};

/// u(X, mu) ~= sum_i F_i(X) G_i^1(mu_1) ... G_i^p(mu_p) on the samples.
struct SeparatedTensor {
  Eigen::MatrixXd F;               ///< (N x m) column i is F_i, in the unit of the field
  std::vector<Eigen::MatrixXd> G;  ///< (p) of (n_j x m), columns of unit length
};

struct GreedySettings {
  double tolerance = 1e-3;  ///< stop at this relative error, |A - A_m| / |A|, all snapshots pooled
  int max_modes = 300;      ///< or at this many modes
  /// After each new mode, all functions F and G of all modes once more in turn, each the least
  /// squares answer to the others. Worth it: at 1e-4, 1.1 times the modes of a POD instead of 1.6.
  /// Updating the parameter functions alone buys nothing.
  bool update_all = true;
  int max_passes = 100;          ///< of alternating directions per mode
  double pass_tolerance = 1e-5;  ///< a mode is done when its size changes less than this, relative
};

struct GreedyResult {
  SeparatedTensor separated;
  /// (m) relative pooled error after 1, 2, ... modes. Where update_all is set, the functions of a
  /// reduction stopped at i modes are not the first i of a longer one.
  Eigen::VectorXd errors;
  bool reached = false;  ///< the tolerance, before max_modes
  /// Relative pooled error of `separated`, from the snapshots themselves and not from the course of
  /// the algorithm; and the same for each snapshot in its own norm (K), 0 for a zero snapshot.
  double error = 0;
  Eigen::VectorXd snapshot_errors;
};

/// Greedy rank-one approximation by alternating directions: each mode is the best found
///
///     min | R - F o G^1 o ... o G^p |_w,   R what the modes before leave of the snapshots,
///
/// freeing one function at a time while the others stand still, beginning at R's largest snapshot.
/// Norm: |a|_w^2 = sum_n w_n a_n^2; with nodal volumes as weights, an integral over the body.
///
/// Works in the coordinates of the snapshots' POD: A = Q C with Q orthonormal in the weighted norm,
/// from the eigenvectors of the K x K Gram matrix. The sweeps then cost r x K, r <= K, instead of
/// N x K and give the same modes. The Gram matrix squares the condition: parts below 1e-7 of the
/// largest are lost, so tolerances below 1e-6 are refused.
///
/// Deterministic: no random numbers. Once the weights and the tensor are given the answer is fixed.
/// @param weights  (N) > 0
/// @throws Error if the snapshots are all zero or not finite
/// @throws ContractViolation for sizes that do not fit, weights <= 0, tolerance < 1e-6
[[nodiscard]] GreedyResult separate(const SnapshotTensor& snapshots, const Eigen::VectorXd& weights,
                                    const GreedySettings& settings, const Progress& progress = {});

/// The same from a source that is read twice, in blocks of about 200 MB.
[[nodiscard]] GreedyResult separate(const SnapshotRows& snapshots, const Eigen::VectorXd& weights,
                                    const GreedySettings& settings, const Progress& progress = {});

/// The same without the change of coordinates: two hundred times slower, for comparison in tests.
[[nodiscard]] GreedyResult separate_in_full_space(const SnapshotTensor& snapshots,
                                                  const Eigen::VectorXd& weights,
                                                  const GreedySettings& settings,
                                                  const Progress& progress = {});

/// (N x K) what the modes say the snapshots are.
[[nodiscard]] Eigen::MatrixXd expand(const SeparatedTensor& separated);

}  // namespace palpable
