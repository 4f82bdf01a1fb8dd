/// @file
/// Finds a free position for a body on a desk that has things on it. Camera frame, m.
#pragma once

#include "palpable/live/map/plane_fit.h"

#include <optional>

namespace palpable {

/// The space that a body occupies: an upright cylinder around its Z axis.
struct Footprint {
  double radius = 0;  ///< m
  double height = 0;  ///< m
};

/// A point of the plane at which a body can stand, in two conditions: no measured point lies inside
/// the body's cylinder or within 15 mm beside it, and 85 % of the plane below the body was measured
/// (so the body is not put behind an object, where the plane is hidden).
///
/// Returns plane.middle if it fulfils both, otherwise the point nearest to the picture's middle
/// that does. If none has 85 % of the plane below it measured, 50 % suffice, and then 0 %: a bare
/// desk has few depths.
///
/// Works on a grid of 10 mm, which counts per cell the samples of the plane and the samples above
/// it, up to the body's height. Cells that are hidden by things have neither. Costs some
/// milliseconds and allocates.
/// @param body  radius at most 1 m
/// @return nothing if there is no such point
[[nodiscard]] std::optional<Eigen::Vector3d> free_place_on(const Plane& plane,
                                                           const DepthImage& depth,
                                                           const PinholeCamera& camera,
                                                           const DepthNoise& noise,
                                                           const Footprint& body);

}  // namespace palpable
