/// @file
/// What a walk along an obstacle's way (contact.h) cannot see: an obstacle that goes through the
/// body between two steps, and one that has the body inside where its way begins.
#pragma once

#include "palpable/bake/solid/obstacle.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <optional>
#include <string>

namespace palpable {

/// The part of a step in which an obstacle and a body overlap.
struct Overlap {
  double begin, end;  ///< times of the motion
};

/// What counts as an overlap with the body.
enum class OverlapOf {
  kAnyPoint,  ///< of an obstacle that does not touch the body where the step begins
  /// Only ObstacleGaps::core() inside the body: of one that touches it there, lies in a dent, and
  /// may slide out of it over the rim.
  kCore,
};

/// Samples the way of the obstacle between two times, at the second of which it does not touch the
/// body. The
/// samples are an eighth of the body's smallest extent apart, or, in a longer step, a 512th of it.
/// @param skin  m, deformed as it is at `from`
/// @return nothing where it passes the body by
[[nodiscard]] std::optional<Overlap> overlap_between(const ObstacleMotion& motion,
                                                     const SurfaceMesh& skin, double from,
                                                     double to,
                                                     OverlapOf what = OverlapOf::kAnyPoint);

/// Steps of a motion from 0 to 1 of which some fall into the overlap; at most 10000.
[[nodiscard]] int steps_to_meet(const Overlap& overlap);

/// Why an obstacle cannot begin there: the whole body lies inside one of its parts. Empty: it can.
[[nodiscard]] std::string swallowed_text(const Obstacle& obstacle, const SurfaceMesh& skin);

}  // namespace palpable
