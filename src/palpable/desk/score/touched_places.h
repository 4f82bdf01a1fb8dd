/// @file
/// Where a true skin is touched: one place or, of a hand with finger and thumb, several.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// m round a touched point that belong to the touched place.
inline constexpr double kTouchedPlace = 0.010;

/// m: a skin is touched where a sample of it is this near to what presses. Samples 2 mm apart leave
/// at most 0.46 mm between the nearest of them and a pencil's tip (radius 1.2 mm) that lies on the
/// skin; between a solver's contact points the two overlap by less.
inline constexpr double kTouches = 0.0005;

/// Points of the skin at rest that cover all that is touched: each touched sample of a triangle
/// (deepest_sample.h, one for each capsule) lies within kTouchedPlace of one of them. They are
/// chosen among these samples, always the one next that moves farthest. None: nothing touches.
/// @param rest      m, the true skin at rest
/// @param deformed  the same skin where it is pressed: same vertices, same triangles
/// @param hand      m, the frame of the skin
/// @throws ContractViolation when the skins differ in vertices or triangles
[[nodiscard]] std::vector<Eigen::Vector3d> touched_places(const SurfaceMesh& rest,
                                                          const SurfaceMesh& deformed,
                                                          std::span<const Capsule> hand);

}  // namespace palpable
