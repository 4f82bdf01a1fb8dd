/// @file
/// Finds the poses that agree best with measured relative poses of pairs of them (ties). After a
/// loop the first and the last pose are tied, and the drift between them is distributed among all
/// poses between.
///
/// A tie is a measured pose of camera a relative to camera b. Its residual is the difference
/// between the tie and the relative pose that follows from the two poses,
///
///     E = b_from_a (a_from_world) (b_from_world)^-1,   r = (translation of E, log of its rotation)
///
/// and the sum of |r / sigma|^2 is minimised by Levenberg and Marquardt's method on a sparse system
/// (Grisetti et al., "A tutorial on graph-based SLAM", 2010).
///
///   P  poses    T  ties
#pragma once

#include "palpable/live/track/sighting.h"

#include <vector>

namespace palpable {

struct PoseTie {
  int a = 0, b = 0;  ///< 0..P-1, different
  Rigid3 b_from_a = Rigid3::Identity();
  double sigma_way = 1;   ///< m, of the translation
  double sigma_turn = 1;  ///< rad, of the rotation
};

struct PoseGraph {
  std::vector<Rigid3> camera_from_world;  ///< (P) the first is not changed
  std::vector<PoseTie> ties;              ///< (T) must connect each pose to the first
};

/// The residual r of a tie, (6) m and rad, and its derivatives with respect to small motions of a
/// and b (moved_by).
struct TieResidual {
  Twist r = Twist::Zero();
  Eigen::Matrix<double, 6, 6> by_a, by_b;
};
[[nodiscard]] TieResidual residual_of(const PoseTie& tie, const Rigid3& a_from_world,
                                      const Rigid3& b_from_world);

struct PoseGraphResult {
  bool solved = false;                   ///< false: a pose has no ties; the poses are unchanged
  int steps = 0;                         ///< number of steps that lowered the cost
  double first_cost = 0, last_cost = 0;  ///< sum of |r / sigma|^2
};

/// Improves the poses in place. Takes some milliseconds for hundreds of poses.
/// @throws ContractViolation when indices are out of range or sigmas are not positive
PoseGraphResult adjust_pose_graph(PoseGraph& graph);

}  // namespace palpable
