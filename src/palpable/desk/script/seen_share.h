/// @file
/// How much of a touch a stereo camera can see.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_distance.h"

#include <Eigen/Core>

#include <span>

namespace palpable {

/// Points of the touching part: the surface of all that moves, where it lies inside a body.
/// @param movers   body frame, m
/// @param spacing  m, > 0, between neighbouring points
/// @return (3 x P), body frame; at most `most` of them, spread evenly
[[nodiscard]] Eigen::Matrix3Xd touching_part(std::span<const Capsule> movers,
                                             const SurfaceDistance& body, double spacing, int most);

/// The share of points on what moves that at least one eye sees: they lie inside the left picture,
/// and what moves does not hide them from both eyes. Nothing else stands before them: the body is
/// virtual.
/// @param points  (3 x P), on the surface of the movers; left camera, m
/// @param movers  left camera, m
/// @return 0..1; 0 without points
[[nodiscard]] double seen_share(const Eigen::Matrix3Xd& points, std::span<const Capsule> movers,
                                const RectifiedStereo& eyes);

}  // namespace palpable
