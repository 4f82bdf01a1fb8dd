/// @file
/// Runs a reduction method on a table of snapshots of which only the Gram matrix is known. Shapes:
/// snapshot_tensor.h; r is the number of POD coordinates.
#pragma once

#include "palpable/bake/separate/pod.h"
#include "palpable/bake/separate/reduction.h"

namespace palpable {

/// Share of the tolerance that the truncation to POD coordinates may use up.
inline constexpr double kCoordinatesShare = 0.01;

struct CoordinateReduction {
  PodCoordinates Q;             ///< of the scaled snapshots, those divided by `scale`
  Eigen::VectorXd scale;        ///< (K) divisor of each snapshot; 1 without weight_snapshots
  SeparatedTensor modes;        ///< F in coordinates (r x m); G reproduces the unscaled snapshots
  Eigen::VectorXd errors;       ///< (m) after 1, 2, ... modes, in the norm of the scaled snapshots
  bool reached = false;         ///< the tolerance, before max_modes
  std::vector<int> ranks;       ///< kHosvd
  std::optional<double> bound;  ///< kHosvd
  Eigen::MatrixXd left_by_modes = {};  ///< Separation::left of the scaled snapshots

  /// (K x m) The functions of space (N x m) are A times this.
  [[nodiscard]] Eigen::MatrixXd combination() const;
  /// (K) squared norm of each snapshot's residual.
  [[nodiscard]] Eigen::VectorXd left(const Eigen::MatrixXd& gram) const;
  /// (m x K) the same after 1, 2, ... modes; with kHosvd after 1, 2, ... functions of space.
  [[nodiscard]] Eigen::MatrixXd course(const Eigen::MatrixXd& gram) const;
};

/// @param gram      (K x K) lower triangle
/// @param settings  any method but kPerSite
[[nodiscard]] CoordinateReduction reduce_in_coordinates(const Eigen::MatrixXd& gram,
                                                        const std::vector<int>& sizes,
                                                        const ReductionSettings& settings,
                                                        const Progress& progress = {});

/// The settings with which kPerSite reduces each site. If one parameter remains beside the site,
/// POD gives the best modes (kPod); if several remain, each gets functions of its own (kPgd).
[[nodiscard]] ReductionSettings settings_of_one_site(const ReductionSettings& settings,
                                                     const std::vector<int>& sizes);

}  // namespace palpable
