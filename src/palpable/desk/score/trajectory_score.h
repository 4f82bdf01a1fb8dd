/// @file
/// The error of a camera's path with respect to the true one.
///
///   n  pairs of poses that match in time
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace palpable {

/// A true and a found world_from_camera and the time of the true one.
struct PosePair {
  double time = 0;  ///< s
  Rigid3 truth = Rigid3::Identity();
  Rigid3 found = Rigid3::Identity();
};

/// Pairs each true pose with the found pose nearest in time, in the order of the true poses.
/// @param truth, found  times strictly increasing
/// @param largest_gap   s; true poses without a found pose within it are skipped
[[nodiscard]] std::vector<PosePair> match_in_time(std::span<const StampedPose> truth,
                                                  std::span<const StampedPose> found,
                                                  double largest_gap);

/// The rigid transform that brings the found positions nearest to the true ones (Umeyama 1991,
/// without scale, by the singular values of the covariance):
///
///     argmin over rotations R and t of  sum_i |t_true_i - (R t_found_i + t)|^2
///
/// If the positions lie on a line or at a point, the rotation is not unique; any minimiser is
/// returned.
/// @param pairs  at least one
[[nodiscard]] Rigid3 align_positions(std::span<const PosePair> pairs);

struct TrajectoryScore {
  int poses = 0;  ///< number of pairs
  /// Absolute trajectory error, m: root mean square of |t_true - A t_found| with the alignment A
  /// above (Sturm et al., IROS 2012).
  double ate = 0;
  /// Relative pose error over `span` seconds. With the motions T_i = X_i^-1 X_j between each pose i
  /// and the first pose j at least `span` later, it is the root mean square over i of the length of
  /// the translation of T_true_i^-1 T_found_i, m, and of its rotation angle, rad. It needs no
  /// alignment. Nothing when the path is shorter than `span`.
  std::optional<double> rpe;
  std::optional<double> rpe_angle;
};

/// @param pairs  at least one, times increasing
/// @param span   s, > 0; a pose j later than 1.5 times the span is not used
[[nodiscard]] TrajectoryScore score_trajectory(std::span<const PosePair> pairs, double span = 1.0);

}  // namespace palpable
