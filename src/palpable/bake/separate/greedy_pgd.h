/// @file
/// Non-intrusive PGD: approximates a table of snapshots by a short sum of separated modes (paper
/// Sec. 3.2). Shapes: snapshot_tensor.h.
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"
#include "palpable/common/base/progress.h"

namespace palpable {

struct GreedySettings {
  /// Runs GreedyPgd::improve() after each new mode. At a tolerance of 1e-4 this
  /// needs 1.1 times as many modes as a POD instead of 1.6 times. Updating the functions of the
  /// parameters alone does not lower the number.
  bool update_all = true;
  int max_passes = 100;          ///< of alternating directions per mode
  double pass_tolerance = 1e-5;  ///< a mode has converged when its norm changes by a smaller share
};

/// Greedy rank-one approximation by alternating directions. Each mode is a local minimum of
///
///     min | R - F o G^1 o ... o G^p |,   R = snapshots - the modes before,
///
/// found by solving for one function at a time while the others are fixed, starting from the
/// largest snapshot of R. Any number of parameters p >= 1; with one (all parameters taken together)
/// the modes are those of the singular value decomposition.
///
/// Deterministic: no random numbers. A pass costs N K operations, so pass the coordinates of the
/// snapshots in their POD basis (pod.h): there N is a few hundred, and the modes are
/// the same.
/// @throws Error if the snapshots are all zero
/// @throws ContractViolation for sizes that do not fit, or bounds below one
[[nodiscard]] Separation greedy_pgd(const SnapshotTensor& snapshots, const ReductionGoal& goal,
                                    const GreedySettings& settings = {},
                                    const Progress& progress = {});

/// The same algorithm step by step: the caller adds one mode at a time.
class GreedyPgd {
 public:
  /// @param snapshots, settings  outlive this
  GreedyPgd(const SnapshotTensor& snapshots, const GreedySettings& settings);

  void add_mode();
  /// One round of alternating least squares over all functions of all modes; CP-ALS runs several
  /// for each number of modes. Returns whether it lowered the error.
  bool improve();

  /// Relative: the norm of the residual divided by that of the snapshots.
  [[nodiscard]] double error() const { return left_.norm() / norm_; }
  /// (K) squared norm of each snapshot's residual.
  [[nodiscard]] Eigen::VectorXd left() const { return left_.colwise().squaredNorm(); }
  [[nodiscard]] const SeparatedTensor& separated() const { return separated_; }

 private:
  [[nodiscard]] SeparatedTensor best_rank_one() const;

  const SnapshotTensor& snapshots_;
  const GreedySettings& settings_;
  Eigen::MatrixXd left_;  // (N x K) the residual: snapshots minus modes
  double norm_;
  SeparatedTensor separated_;
};

}  // namespace palpable
