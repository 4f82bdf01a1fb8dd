/// @file
/// How deep a real hand is left inside the body that should have given way to it.
#pragma once

#include "palpable/geometry/capsule.h"

#include <Eigen/Core>

#include <span>

namespace palpable {

/// Distance of x to the capsule's surface, m, negative inside: the smallest |x - c| - r over the
/// capsule's balls (middle c, radius r). Exact, closed form.
[[nodiscard]] double distance_to(const Capsule& capsule, const Eigen::Vector3d& x);

/// The deepest of the vertices inside the capsules, m; 0 when none is inside.
/// @param vertices  (3 x V) m, in the frame of the capsules
[[nodiscard]] double deepest_penetration(const Eigen::Matrix3Xd& vertices,
                                         std::span<const Capsule> capsules);

}  // namespace palpable
