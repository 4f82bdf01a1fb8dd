/// @file
/// The poses that agree best with what is known about pairs of them (ties). After a loop the first
/// and the last pose are tied, and the drift between them is shared among all poses between.
///
/// A tie says where camera a stood as seen from camera b. Its residual is what is left of going
/// from b to a by the poses and back by the tie,
///
///     E = b_from_a (a_from_world) (b_from_world)^-1,   r = (translation of E, log of its rotation)
///
/// and the sum of |r / sigma|^2 is lowered by Levenberg and Marquardt's method on a sparse system
/// (Grisetti et al., "A tutorial on graph-based SLAM", 2010).
///
///   P  poses    T  ties
#pragma once

#include "palpable/live/track/sighting.h"

#include <vector>

namespace palpable {

struct PoseTie {
  int a = 0, b = 0;  ///< 0..P-1, not the same
  Rigid3 b_from_a = Rigid3::Identity();
  double sigma_way = 1;   ///< m, of the translation
  double sigma_turn = 1;  ///< rad
};

struct PoseGraph {
  std::vector<Rigid3> camera_from_world;  ///< (P) the first stays as it is
  std::vector<PoseTie> ties;              ///< (T) chains of them lead from each pose to the first
};

/// r of a tie, (6) m and rad, and its derivatives with respect to small motions of a and b
/// (moved_by).
struct TieResidual {
  Twist r = Twist::Zero();
  Eigen::Matrix<double, 6, 6> by_a, by_b;
};
[[nodiscard]] TieResidual residual_of(const PoseTie& tie, const Rigid3& a_from_world,
                                      const Rigid3& b_from_world);

struct PoseGraphResult {
  bool solved = false;                   ///< false: a pose has no ties; the poses are as they were
  int steps = 0;                         ///< that lowered the cost
  double first_cost = 0, last_cost = 0;  ///< sum of |r / sigma|^2
};

/// Improves the poses in place. Takes some milliseconds for hundreds of poses.
/// @throws ContractViolation when indices are out of range or sigmas are not positive
PoseGraphResult adjust_pose_graph(PoseGraph& graph);

}  // namespace palpable
