/// @file
/// A table of snapshots in, a separated field out: all methods behind one function. Which is which,
/// with equations and sources: docs/reduction.md. Shapes: snapshot_tensor.h.
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"
#include "palpable/common/base/progress.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

enum class ReductionMethod {
  kPerSite,  ///< for each sample of the first parameter a block of modes of its own
  kPgd,      ///< greedy PGD, a function of each parameter (paper Sec. 3.2)
  kPgd2,     ///< greedy PGD in two factors: space, and all parameters together
  kPod,      ///< singular value decomposition
  kCp,       ///< CP-ALS
  kHosvd     ///< ST-HOSVD (Tucker)
};

/// What a reduction is asked for unless somebody says otherwise. Of the per-site form: what keeps
/// held-out levels of a body within 1e-3 of each field's own norm, and von Mises stress within 5e-3
/// of its own maximum (docs/reduction.md); of the others the paper's.
[[nodiscard]] double default_tolerance(ReductionMethod method);

/// "per-site", "pgd", "pgd2", "pod", "cp", "hosvd"
[[nodiscard]] std::string_view method_name(ReductionMethod method);
[[nodiscard]] std::optional<ReductionMethod> method_named(std::string_view name);
[[nodiscard]] std::vector<std::string> method_names();

struct ReductionSettings {
  ReductionMethod method = ReductionMethod::kPerSite;
  /// Relative error that is asked for: pooled over all snapshots, or with kPerSite over those of
  /// each site; at least 1e-6.
  double tolerance = 1e-3;
  int max_modes = 300;  ///< with kPerSite of each site
  /// Each snapshot is divided by its own norm first, so that small presses count as much as large
  /// ones; with several functions per mode, by the nearest separated norm (separated_norms()). The
  /// tolerance and `errors` are then in that norm; `error` and `snapshot_errors` never are.
  bool weight_snapshots = false;
};

/// What is left of a tensor: modes, and how much they give up.
struct Reduction {
  /// One separated tensor; with kPerSite one for each sample of the first parameter, over the
  /// others. Of kPgd2, kPod and kHosvd the functions G are one table over all parameters together.
  std::vector<SeparatedTensor> blocks;
  /// (m) after 1, 2, ... modes, relative and pooled; with kPerSite the worst site's, all with that
  /// many modes. kHosvd: none.
  Eigen::VectorXd errors;
  bool reached = false;  ///< the tolerance, before max_modes
  /// Relative pooled error from the snapshots themselves and not from the course of the algorithm;
  /// and that of each snapshot in its own norm (K), 0 for a zero snapshot.
  double error = 0;
  Eigen::VectorXd snapshot_errors;
  /// (m) and (m x K) the same after 1, 2, ... modes: with kPerSite so many of each site, with
  /// kHosvd of space. From the course of the algorithm but for the last, which are those above.
  Eigen::VectorXd pooled_course;
  Eigen::MatrixXd course;
  std::vector<int> ranks;       ///< kHosvd only: space, then each parameter
  std::optional<double> bound;  ///< kHosvd only: what the error cannot exceed, in the weighted norm

  [[nodiscard]] int most_modes() const;   ///< of one block
  [[nodiscard]] int total_modes() const;  ///< of all blocks
};

/// Reduces in the norm |a|_w^2 = sum_n w_n a_n^2: with nodal volumes as weights, an integral over
/// the body. Reads the snapshots of one sample of the first parameter at a time, twice, and keeps
/// about a third of the table (site_bases.h); tables above 2 GB are read in blocks of rows of about
/// 200 MB instead. With kPerSite once, N K / n_1 values at a time. Methods work in POD coordinates
/// (pod_coordinates.h), those of kPerSite in each site's own; a hundredth of the tolerance goes
/// there.
///
/// Deterministic: no random numbers, one thread.
/// @param weights  (N) > 0
/// @throws Error if the snapshots are all zero or not finite
/// @throws ContractViolation for sizes that do not fit, weights <= 0, tolerance < 1e-6
[[nodiscard]] Reduction reduce(const SnapshotRows& snapshots, const Eigen::VectorXd& weights,
                               const ReductionSettings& settings, const Progress& progress = {});

/// Modes over all parameters together, as one block for each sample of the first parameter, so that
/// somebody who evaluates one sample needs few of them. Each is cut where it changes by less than
/// the part `lose` of itself, in the weighted norm.
/// @param joint  G is one (n_1 n x m) table
[[nodiscard]] std::vector<SeparatedTensor> as_blocks(const SeparatedTensor& joint, int n_1,
                                                     const Eigen::VectorXd& weights, double lose);

/// (N x K) what the modes say the snapshots are. @param sizes  of the tensor
[[nodiscard]] Eigen::MatrixXd expand(const Reduction& reduction, const std::vector<int>& sizes);

}  // namespace palpable
