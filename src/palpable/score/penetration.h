/// @file
/// How deep a real hand is left inside the body that should have given way to it.
#pragma once

#include <Eigen/Core>

#include <span>

namespace palpable {

/// The truth's building block: all that lies in one of the balls that roll from a (radius ra) to b
/// (radius rb), the radius changing linearly. Camera frame, m.
struct TrueCapsule {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double ra = 0;
  double rb = 0;
};

/// min over the balls of |x - c| - r(c), m: negative inside. Exact, closed form.
[[nodiscard]] double distance_to(const TrueCapsule& capsule, const Eigen::Vector3d& x);

/// The deepest of the vertices inside the capsules, m; 0 when none is inside.
/// @param vertices  (3 x V) m, in the frame of the capsules
[[nodiscard]] double deepest_penetration(const Eigen::Matrix3Xd& vertices,
                                         std::span<const TrueCapsule> capsules);

}  // namespace palpable
