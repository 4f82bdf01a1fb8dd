/// @file
/// Where a true skin is touched: at one place, or at several, as by finger and thumb.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// m, radius of a touched place around its point.
inline constexpr double kTouchedPlace = 0.010;

/// m; a skin is touched where a sample of it is this near to the obstacle. If a pencil's tip
/// (radius 1.2 mm) lies on the skin, the nearest of samples 2 mm apart is at most 0.46 mm from the
/// tip; the penetration between the contact points of a solver is smaller than this.
inline constexpr double kTouches = 0.0005;

/// Points of the skin at rest that cover its touched part: each touched sample (deepest_sample.h,
/// one per triangle and capsule) lies within kTouchedPlace of one of them. They are chosen greedily
/// among the samples, the one with the largest displacement first. Empty if nothing touches.
/// @param rest      m, the true skin at rest
/// @param deformed  the same skin under load: same vertices, same triangles
/// @param hand      m, in the frame of the skin
/// @throws ContractViolation when the skins differ in vertices or triangles
[[nodiscard]] std::vector<Eigen::Vector3d> touched_places(const SurfaceMesh& rest,
                                                          const SurfaceMesh& deformed,
                                                          std::span<const Capsule> hand);

}  // namespace palpable
