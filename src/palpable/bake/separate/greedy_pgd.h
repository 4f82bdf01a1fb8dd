/// @file
/// Non-intrusive PGD: a table of snapshots as a short sum of separated modes (paper Sec. 3.2).
/// Shapes: snapshot_tensor.h.
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"
#include "palpable/common/base/progress.h"

namespace palpable {

struct GreedySettings {
  /// After each new mode, all functions F and G of all modes once more in turn, each the least
  /// squares answer to the others. Worth it: at 1e-4, 1.1 times the modes of a POD instead of 1.6.
  /// Updating the parameter functions alone buys nothing.
  bool update_all = true;
  int max_passes = 100;          ///< of alternating directions per mode
  double pass_tolerance = 1e-5;  ///< a mode is done when its size changes less than this, relative
};

/// Greedy rank-one approximation by alternating directions: each mode is the best found
///
///     min | R - F o G^1 o ... o G^p |,   R what the modes before leave of the snapshots,
///
/// freeing one function at a time while the others stand still, beginning at R's largest snapshot.
/// Any number of parameters p >= 1; with one (all parameters taken together) the modes are those of
/// the singular value decomposition.
///
/// Deterministic: no random numbers. Costs N K a pass: hand it the coordinates of snapshots in
/// their POD basis (pod_coordinates.h), where N is a few hundred and the modes are the same.
/// @throws Error if the snapshots are all zero
/// @throws ContractViolation for sizes that do not fit, or bounds below one
[[nodiscard]] Separation greedy_pgd(const SnapshotTensor& snapshots, const ReductionGoal& goal,
                                    const GreedySettings& settings = {},
                                    const Progress& progress = {});

/// The sweep step by step: one more mode at a time.
class GreedyPgd {
 public:
  /// @param snapshots, settings  outlive this
  GreedyPgd(const SnapshotTensor& snapshots, const GreedySettings& settings);

  void add_mode();
  /// A round of improve_all_functions(); whether it helped.
  bool improve();

  [[nodiscard]] double error() const { return left_.norm() / norm_; }
  /// (K) squares of what is left of each snapshot.
  [[nodiscard]] Eigen::VectorXd left() const { return left_.colwise().squaredNorm(); }
  [[nodiscard]] const SeparatedTensor& separated() const { return separated_; }

 private:
  [[nodiscard]] SeparatedTensor best_rank_one() const;

  const SnapshotTensor& snapshots_;
  const GreedySettings& settings_;
  Eigen::MatrixXd left_;  // the snapshots less the modes
  double norm_;
  SeparatedTensor separated_;
};

}  // namespace palpable
