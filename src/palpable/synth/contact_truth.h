/// @file
/// The truth of touching: the surface of a hand or a thing against the undeformed body.
#pragma once

#include "palpable/synth/capsule.h"
#include "palpable/synth/desk_body.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// Whether and how deep a hand reaches into a body.
struct ContactTruth {
  bool touching = false;  ///< a point of the body lies inside a capsule
  double depth = 0;      ///< m, >= 0: how deep the deepest such point lies under the hand's surface
  int vertex = -1;       ///< the deepest; -1 when not touching
  double clearance = 0;  ///< m: distance of the nearest point when not touching, else 0
};

/// @param vertices  (3 x V) of the body, in the frame of the capsules
[[nodiscard]] ContactTruth contact_truth(std::span<const Capsule> hand,
                                         const Eigen::Matrix3Xd& vertices);

/// contact_truth(hand, points).touching, sooner.
[[nodiscard]] bool touches(std::span<const Capsule> hand, const Eigen::Matrix3Xd& points);

/// Vertices of the body inside the hand, in increasing order.
[[nodiscard]] std::vector<int> vertices_inside(std::span<const Capsule> hand,
                                               const Eigen::Matrix3Xd& vertices);

/// How far a hand reaches below a body's surface.
///
/// The deepest place is the point of the surface, inside the hand, from which the way straight into
/// the body leaves the hand last. That way is the depth: what a finger that comes along the normal
/// has moved on since it touched. (How deep the point lies under the hand's own surface cannot
/// exceed the finger's radius.)
struct PressTruth {
  bool touching = false;
  double depth = 0;  ///< m, >= 0
  int point = -1;    ///< index in `body`; -1 when not touching
};

/// @param body  in the frame of the capsules
[[nodiscard]] PressTruth press_truth(std::span<const Capsule> hand, const SurfacePoints& body);

}  // namespace palpable
