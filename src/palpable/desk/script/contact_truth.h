/// @file
/// The truth of touching: the surface of a hand or a thing against the undeformed body.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/desk/script/desk_body.h"

#include <Eigen/Core>

#include <limits>
#include <span>

namespace palpable {

/// Whether points of a body lie inside a hand, and how deep, or how far away they are.
struct ContactTruth {
  bool touching = false;  ///< a point of the body lies inside a capsule
  double depth = 0;      ///< m, >= 0: how deep the deepest such point lies below the hand's surface
  int vertex = -1;       ///< that point; -1 when not touching
  double clearance = 0;  ///< m: from the hand to the nearest point; 0 when touching
};

/// @param vertices  (3 x V) of the body, in the frame of the capsules
/// @param farthest  m: a clearance beyond it is not looked for and given as this, which is quicker
[[nodiscard]] ContactTruth contact_truth(std::span<const Capsule> hand,
                                         const Eigen::Matrix3Xd& vertices,
                                         double farthest = std::numeric_limits<double>::infinity());

/// The same as contact_truth(hand, points).touching, but much faster.
[[nodiscard]] bool touches(std::span<const Capsule> hand, const Eigen::Matrix3Xd& points);

/// How far a hand reaches below a body's surface.
///
/// From each point of the surface that lies inside the hand a straight line runs into the body
/// until it leaves the hand. The longest of these lines is the depth: as far as a finger that comes
/// along the normal has moved on since it touched. (ContactTruth::depth, measured from the hand's
/// own surface, cannot exceed the finger's radius.)
struct PressTruth {
  bool touching = false;
  double depth = 0;  ///< m, >= 0
  int point = -1;    ///< where the longest line begins, index in `body`; -1 when not touching
};

/// @param body  in the frame of the capsules
[[nodiscard]] PressTruth press_truth(std::span<const Capsule> hand, const SurfacePoints& body);

}  // namespace palpable
