/// @file
/// A method on a table of snapshots of which only the Gram matrix is known. Shapes:
/// snapshot_tensor.h; r POD coordinates.
#pragma once

#include "palpable/bake/separate/pod_coordinates.h"
#include "palpable/bake/separate/reduction.h"

namespace palpable {

/// The part of the tolerance that the change of coordinates may take.
inline constexpr double kCoordinatesShare = 0.01;

struct CoordinateReduction {
  PodCoordinates Q;        ///< of the snapshots divided by `scale`
  Eigen::VectorXd scale;   ///< (K) 1, or with own norms what each is divided by
  SeparatedTensor modes;   ///< F in coordinates (r x m); G over the snapshots as they are
  Eigen::VectorXd errors;  ///< (m) in the norm of the divided snapshots
  bool reached = false;
  std::vector<int> ranks;              ///< kHosvd
  std::optional<double> bound;         ///< kHosvd
  Eigen::MatrixXd left_by_modes = {};  ///< Separation::left of the divided snapshots

  /// (N x m) is A times this.
  [[nodiscard]] Eigen::MatrixXd combination() const;
  /// (K) squares of what is left of each snapshot.
  [[nodiscard]] Eigen::VectorXd left(const Eigen::MatrixXd& gram) const;
  /// (m x K) the same after 1, 2, ... modes; kHosvd: functions of space.
  [[nodiscard]] Eigen::MatrixXd course(const Eigen::MatrixXd& gram) const;
};

/// @param gram      (K x K) lower triangle
/// @param settings  any method but kPerSite
[[nodiscard]] CoordinateReduction reduce_in_coordinates(const Eigen::MatrixXd& gram,
                                                        const std::vector<int>& sizes,
                                                        const ReductionSettings& settings,
                                                        const Progress& progress = {});

/// What kPerSite does with each site: with one parameter left the best modes are known (kPod); with
/// more, each has functions of its own (kPgd).
[[nodiscard]] ReductionSettings settings_of_one_site(const ReductionSettings& settings,
                                                     const std::vector<int>& sizes);

}  // namespace palpable
