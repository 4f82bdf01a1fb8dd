/// @file
/// Compares the reduction methods on one table of snapshots: number of modes, bytes and errors of
/// each.
#pragma once

#include "palpable/bake/separate/reduction.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// Bytes, in single precision, of `columns` modes of n values each and the functions of their
/// parameters.
[[nodiscard]] inline double mode_bytes(Eigen::Index n, int columns, double parameter_values) {
  return 4.0 * (static_cast<double>(n) * columns + parameter_values);
}

/// The figures of a method if it had stopped at a smaller number of modes.
struct MethodStep {
  int modes = 0;                ///< as MethodFigures::modes; kHosvd: functions of space
  int columns = 0;              ///< of all blocks
  double parameter_values = 0;  ///< as MethodFigures::parameter_values
  double pooled = 0, median = 0, worst = 0;
};

struct MethodFigures {
  ReductionMethod method = ReductionMethod::kPerSite;
  int modes = 0;                ///< kPerSite: the largest number of modes of a block
  int columns = 0;              ///< of all blocks
  double parameter_values = 0;  ///< numbers in the functions of parameters; kHosvd: and in the core
  std::vector<int> ranks = {};  ///< kHosvd
  bool reached = false;
  Eigen::VectorXd errors = {};  ///< as Reduction::errors
  /// Relative errors: over all snapshots together; median and largest of the single snapshots, each
  /// relative to its own norm.
  double pooled = 0, median = 0, worst = 0;
  double seconds = 0;                  ///< wall time, without that for the Gram matrix
  std::vector<MethodStep> steps = {};  ///< after 1, 2, ... modes

  /// mode_bytes() of this method's modes at n values each.
  [[nodiscard]] double bytes(Eigen::Index n) const {
    return mode_bytes(n, columns, parameter_values);
  }
};

/// Computes the figures from the Gram matrix alone, which determines all errors in POD coordinates
/// (pod.h).
/// @param gram   (K x K) lower triangle, gram_of()
/// @param sizes  (p) of the tensor, p >= 2
/// @throws as reduce()
[[nodiscard]] MethodFigures try_method(const Eigen::MatrixXd& gram, const std::vector<int>& sizes,
                                       const ReductionSettings& settings,
                                       const Progress& progress = {});

}  // namespace palpable
