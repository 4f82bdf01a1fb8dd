/// @file
/// How deep a real hand is left inside the body that should have given way to it.
#pragma once

#include "palpable/geometry/capsule.h"
#include "palpable/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <span>

namespace palpable {

/// Distance of x to the capsule's surface, m, negative inside: the smallest |x - c| - r over the
/// capsule's balls (middle c, radius r). Exact, closed form.
[[nodiscard]] double distance_to(const Capsule& capsule, const Eigen::Vector3d& x);

/// m: neighbouring samples of a triangle are no farther apart.
inline constexpr double kPenetrationSpacing = 0.002;

/// How deep the deepest sample of the triangles lies inside the capsules, m; 0 when none is inside.
///
/// The samples are the corners of all parts of a triangle that is halved along its edges until they
/// are kPenetrationSpacing long at most (4096 times at most: that ends with a file's triangle of a
/// kilometre). A pencil's tip that lies between three vertices is found so. Parts that cannot hold
/// a deeper sample than the deepest so far are left out.
/// @param surface  m, in the frame of the capsules
[[nodiscard]] double deepest_penetration(const SurfaceMesh& surface,
                                         std::span<const Capsule> capsules);

}  // namespace palpable
