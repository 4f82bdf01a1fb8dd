/// @file
/// Poses that are tied to each other in pairs: what agrees best with all ties. For loops, after
/// which the first and the last pose are known to each other again and the error lies in all
/// between.
///
/// A tie says where camera b stood in camera a. Its residual is what is left of going there and
/// back,
///
///     E = b_from_a (a_from_world) (b_from_world)^-1,   r = (translation of E, log of its rotation)
///
/// and the sum of |r / sigma|^2 is lowered by Levenberg and Marquardt's method on a sparse system
/// (Grisetti et al., "A tutorial on graph-based SLAM", 2010).
///
///   P  poses    T  ties
#pragma once

#include "palpable/track/sighting.h"

#include <vector>

namespace palpable {

struct PoseTie {
  int a = 0, b = 0;  ///< 0..P-1, not the same
  Rigid3 b_from_a = Rigid3::Identity();
  double sigma_way = 1;   ///< m, of the translation
  double sigma_turn = 1;  ///< rad
};

struct PoseGraph {
  std::vector<Rigid3> camera_from_world;  ///< (P) the first stays; the ties hang all on it
  std::vector<PoseTie> ties;              ///< (T)
};

/// r of a tie, (6) m and rad, and its derivatives by small motions of a and b (moved_by).
struct TieResidual {
  Twist r = Twist::Zero();
  Eigen::Matrix<double, 6, 6> by_a, by_b;
};
[[nodiscard]] TieResidual residual_of(const PoseTie& tie, const Rigid3& a_from_world,
                                      const Rigid3& b_from_world);

struct PoseGraphResult {
  bool solved = false;  ///< false: a pose hangs on nothing; the poses are as they were
  int steps = 0;        ///< that lowered the cost
  double first_cost = 0, last_cost = 0;  ///< sum of |r / sigma|^2
};

/// Improves the poses in place. Some milliseconds for hundreds of poses.
/// @throws ContractViolation when indices are out of range or sigmas are not positive
PoseGraphResult adjust_pose_graph(PoseGraph& graph);

}  // namespace palpable
