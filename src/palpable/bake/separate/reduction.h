/// @file
/// Turns a table of snapshots into a separated field; all methods are behind one function.
/// docs/reduction.md describes them with equations and sources. Shapes: snapshot_tensor.h.
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"
#include "palpable/common/base/progress.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

enum class ReductionMethod {
  kPerSite,  ///< a block of modes of its own for each sample of the first parameter (the site)
  kPgd,      ///< greedy PGD, a function of each parameter (paper Sec. 3.2)
  kPgd2,     ///< greedy PGD in two factors: space, and all parameters together
  kPod,      ///< singular value decomposition
  kCp,       ///< CP-ALS
  kHosvd     ///< ST-HOSVD (Tucker)
};

/// The default tolerance of a method. For kPerSite it is the one that keeps held-out levels of a
/// body within 1e-3 of each field's own norm, and von Mises stress within 5e-3 of its own maximum
/// (docs/reduction.md); for the other methods it is the paper's.
[[nodiscard]] double default_tolerance(ReductionMethod method);

/// "per-site", "pgd", "pgd2", "pod", "cp", "hosvd"
[[nodiscard]] std::string_view method_name(ReductionMethod method);
[[nodiscard]] std::optional<ReductionMethod> method_named(std::string_view name);
[[nodiscard]] std::vector<std::string> method_names();

struct ReductionSettings {
  ReductionMethod method = ReductionMethod::kPerSite;
  /// Relative error at which the method stops, over all snapshots together, or with kPerSite over
  /// those of each site; at least 1e-6.
  double tolerance = 1e-3;
  int max_modes = 300;  ///< with kPerSite: of each site
  /// Divide each snapshot by its own norm first, so that small presses count as much as large ones;
  /// for methods with several functions per mode, by the nearest separated norm
  /// (separated_norms()). The tolerance and Reduction::errors then refer to the divided snapshots;
  /// Reduction::error and Reduction::snapshot_errors always refer to the original ones.
  bool weight_snapshots = false;
};

/// The modes that stand for a tensor, and their errors.
struct Reduction {
  /// One separated tensor; with kPerSite one for each sample of the first parameter, over the other
  /// parameters. With kPgd2, kPod and kHosvd G is one table over all parameters together.
  std::vector<SeparatedTensor> blocks;
  /// (m) relative error over all snapshots after 1, 2, ... modes; with kPerSite that of the worst
  /// site when each site has that many modes. Empty with kHosvd.
  Eigen::VectorXd errors;
  bool reached = false;  ///< the tolerance, before max_modes
  /// Relative error over all snapshots, computed from the snapshots themselves instead of the
  /// algorithm's own residuals.
  double error = 0;
  /// (K) error of each snapshot relative to its own norm; 0 for a zero snapshot.
  Eigen::VectorXd snapshot_errors;
  /// (m) and (m x K) `error` and `snapshot_errors` after 1, 2, ... modes: with kPerSite of each
  /// site, with kHosvd of space. They come from the algorithm's residuals, except for the last
  /// entries, which equal `error` and `snapshot_errors`.
  Eigen::VectorXd pooled_course;
  Eigen::MatrixXd course;
  std::vector<int> ranks;       ///< kHosvd only: space, then each parameter
  std::optional<double> bound;  ///< kHosvd only: upper bound of the error in the weighted norm

  [[nodiscard]] int most_modes() const;   ///< of the block that has the most
  [[nodiscard]] int total_modes() const;  ///< of all blocks
};

/// Reduces in the norm |a|_w^2 = sum_n w_n a_n^2: with nodal volumes as weights, an integral over
/// the body.
///
/// kPerSite reads the table once, N K / n_1 values at a time. The other methods read it twice, one
/// sample of the first parameter at a time, and keep about a third of it in memory (site_bases.h);
/// tables above 2 GB they read in blocks of rows of about 200 MB instead. All methods work in POD
/// coordinates (pod.h), kPerSite in those of each site; 1 % of the tolerance is spent
/// on that change of coordinates.
///
/// Deterministic: no random numbers, one thread.
/// @param weights  (N) > 0
/// @throws Error if the snapshots are all zero or not finite
/// @throws ContractViolation for sizes that do not fit, weights <= 0, tolerance < 1e-6
[[nodiscard]] Reduction reduce(const SnapshotRows& snapshots, const Eigen::VectorXd& weights,
                               const ReductionSettings& settings, const Progress& progress = {});

/// Converts modes over all parameters together into one block for each sample of the first
/// parameter, so that evaluating one sample needs few modes. Each block is truncated to the
/// smallest number of modes whose relative error in the weighted norm is at most `lose`.
/// @param joint  G is one (n_1 n x m) table
[[nodiscard]] std::vector<SeparatedTensor> as_blocks(const SeparatedTensor& joint, int n_1,
                                                     const Eigen::VectorXd& weights, double lose);

/// (N x K) the snapshots as the modes reproduce them. @param sizes  (p) n_j of the tensor
[[nodiscard]] Eigen::MatrixXd expand(const Reduction& reduction, const std::vector<int>& sizes);

}  // namespace palpable
