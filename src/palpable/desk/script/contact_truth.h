/// @file
/// The true contact between a hand or thing and the undeformed body.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/desk/script/desk_body.h"

#include <Eigen/Core>

#include <limits>
#include <span>

namespace palpable {

/// Whether points of a body lie inside a hand, with their depth, or else their distance.
struct ContactTruth {
  bool touching = false;  ///< whether a point of the body lies inside a capsule
  double depth = 0;       ///< m, >= 0, of the deepest point below the hand's surface
  int vertex = -1;        ///< index of the deepest point; -1 without a touch
  double clearance = 0;   ///< m, from the hand to the nearest point; 0 with a touch
};

/// @param vertices  (3 x V) m, points of the body in the frame of the capsules
/// @param farthest  m; a larger clearance is not computed but returned as this value, which is
///                  faster
[[nodiscard]] ContactTruth contact_truth(std::span<const Capsule> hand,
                                         const Eigen::Matrix3Xd& vertices,
                                         double farthest = std::numeric_limits<double>::infinity());

/// The same as contact_truth(hand, points).touching, but much faster.
[[nodiscard]] bool touches(std::span<const Capsule> hand, const Eigen::Matrix3Xd& points);

/// How far a hand reaches below the surface of a body.
///
/// From each surface point inside the hand, a straight line along the inward normal runs into the
/// body until it leaves the hand. The longest of these lines is the depth. For a finger that moves
/// along the normal, it is the distance that the finger has moved since it first touched.
/// (ContactTruth::depth, measured from the hand's surface, cannot exceed the radius of the finger.)
struct PressTruth {
  bool touching = false;
  double depth = 0;  ///< m, >= 0
  int point = -1;    ///< index of the start of the longest line; -1 without a touch
};

/// @param body  in the frame of the capsules
[[nodiscard]] PressTruth press_truth(std::span<const Capsule> hand, const SurfacePoints& body);

}  // namespace palpable
