/// @file
/// The share of a touch that a stereo camera can see.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_distance.h"

#include <Eigen/Core>

#include <span>

namespace palpable {

/// Points of the touching part: of the surface of all movers where it lies inside a body.
/// @param movers   body frame, m
/// @param spacing  m, > 0, of neighbouring points
/// @return (3 x P) m, body frame; at most `most` points, spread evenly
[[nodiscard]] Eigen::Matrix3Xd touching_part(std::span<const Capsule> movers,
                                             const SurfaceDistance& body, double spacing, int most);

/// The share of points on movers that at least one eye sees: points that lie inside the left
/// picture and are not hidden by movers from both eyes. Nothing else can hide them, since the body
/// is virtual.
/// @param points  (3 x P), on the surface of the movers; left camera, m
/// @param movers  left camera, m
/// @return 0..1; 0 without points
[[nodiscard]] double seen_share(const Eigen::Matrix3Xd& points, std::span<const Capsule> movers,
                                const RectifiedStereo& eyes);

}  // namespace palpable
