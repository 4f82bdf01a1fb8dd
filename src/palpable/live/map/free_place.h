/// @file
/// Where on a desk with things on it a body can stand. Camera frame, m.
#pragma once

#include "palpable/live/map/plane_fit.h"

#include <optional>

namespace palpable {

/// The room that a body takes: an upright cylinder around its Z axis.
struct Footprint {
  double radius = 0;  ///< m
  double height = 0;  ///< m
};

/// The point of the plane at which a body can stand: nothing that is seen is in its room or within
/// 15 mm beside it, and 85 % of the plane below it is seen: not behind a thing, whose back is not.
/// plane.middle if that is such a point, else the one nearest to the picture's middle; where
/// nowhere so much of the plane is seen, half of it, and then any point that is: a bare desk has
/// few depths.
///
/// On a grid of 10 mm: cells of the plane in which the plane was seen, and cells above which
/// something lower than the body's height was. What things hide is taken for neither. Costs some
/// milliseconds and allocates.
/// @param body  radius at most 1 m
/// @return nothing where no such point is seen
[[nodiscard]] std::optional<Eigen::Vector3d> free_place_on(const Plane& plane,
                                                           const DepthImage& depth,
                                                           const PinholeCamera& camera,
                                                           const DepthNoise& noise,
                                                           const Footprint& body);

}  // namespace palpable
