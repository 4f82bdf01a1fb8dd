/// @file
/// All methods on one table of snapshots: how many modes, bytes and errors each.
#pragma once

#include "palpable/bake/separate/reduction.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// Bytes of so many modes at n values each, single precision, functions of parameters included.
[[nodiscard]] inline double mode_bytes(Eigen::Index n, int columns, double parameter_values) {
  return 4.0 * (static_cast<double>(n) * columns + parameter_values);
}

/// What a method would have been, stopped earlier.
struct MethodStep {
  int modes = 0;                ///< as MethodFigures::modes; kHosvd: functions of space
  int columns = 0;              ///< of all blocks
  double parameter_values = 0;  ///< as MethodFigures::parameter_values
  double pooled = 0, median = 0, worst = 0;
};

struct MethodFigures {
  ReductionMethod method = ReductionMethod::kPerSite;
  int modes = 0;                ///< kPerSite: the most of one sample of the first parameter
  int columns = 0;              ///< of all blocks
  double parameter_values = 0;  ///< numbers in the functions of parameters; kHosvd: and in the core
  std::vector<int> ranks = {};  ///< kHosvd
  bool reached = false;
  Eigen::VectorXd errors = {};               ///< as Reduction::errors
  double pooled = 0, median = 0, worst = 0;  ///< of snapshots in their own norms, the last two
  double seconds = 0;                        ///< by the clock, from the Gram matrix on
  std::vector<MethodStep> steps = {};        ///< after 1, 2, ... modes

  /// Bytes of the modes at n values each, single precision, functions of parameters included.
  [[nodiscard]] double bytes(Eigen::Index n) const {
    return mode_bytes(n, columns, parameter_values);
  }
};

/// From the Gram matrix alone: in POD coordinates (pod_coordinates.h) everything is known.
/// @param gram   (K x K) lower triangle, gram_of()
/// @param sizes  (p) of the tensor, p >= 2
/// @throws as reduce()
[[nodiscard]] MethodFigures try_method(const Eigen::MatrixXd& gram, const std::vector<int>& sizes,
                                       const ReductionSettings& settings,
                                       const Progress& progress = {});

}  // namespace palpable
