/// @file
/// How far a camera's path is from the true one.
///
///   n  poses that have a partner in time
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/stamped_pose.h"

#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace palpable {

/// (true, found) world_from_camera with the time of the true one, in its order.
struct PosePair {
  double time = 0;  ///< s
  Rigid3 truth = Rigid3::Identity();
  Rigid3 found = Rigid3::Identity();
};

/// Gives each true pose the found one that is nearest in time.
/// @param truth, found  times strictly increasing
/// @param largest_gap   s; farther apart is no partner
[[nodiscard]] std::vector<PosePair> match_in_time(std::span<const StampedPose> truth,
                                                  std::span<const StampedPose> found,
                                                  double largest_gap);

/// The rigid transform that brings the found positions nearest to the true ones (Umeyama 1991,
/// without scale, by the singular values of the covariance):
///
///     argmin over rotations R and t of  sum_i |t_true_i - (R t_found_i + t)|^2
///
/// A line or a point leaves the rotation around it open; any of them is then returned.
/// @param pairs  at least one
[[nodiscard]] Rigid3 align_positions(std::span<const PosePair> pairs);

struct TrajectoryScore {
  int poses = 0;  ///< pairs
  /// Absolute trajectory error, m: root mean square of |t_true - A t_found| with the alignment A
  /// above (Sturm et al., IROS 2012).
  double ate = 0;
  /// Relative pose error over `span` seconds: with the motions T_i = X_i^-1 X_j between each pair i
  /// and the first pair j at least `span` later, the root mean square over i of the length of the
  /// translation of T_true_i^-1 T_found_i, m, and of its angle, rad. Needs no alignment. Nothing
  /// when the path is shorter.
  std::optional<double> rpe;
  std::optional<double> rpe_angle;
};

/// @param pairs  at least one, times increasing
/// @param span   s, > 0; a partner up to 1.5 times as late is taken, a later one is not
[[nodiscard]] TrajectoryScore score_trajectory(std::span<const PosePair> pairs, double span = 1.0);

}  // namespace palpable
