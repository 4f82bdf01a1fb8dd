/// @file
/// The truth of touching: the hand's surface against the undeformed body.
#pragma once

#include "palpable/synth/capsule.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// Whether and how deep a hand reaches into a body.
struct ContactTruth {
  bool touching = false;  ///< a vertex of the body lies inside a capsule
  double depth = 0;  ///< m, >= 0: how deep the deepest such vertex lies under the hand's surface
  int vertex = -1;   ///< the deepest; -1 when not touching
  double clearance = 0;  ///< m: distance of the nearest vertex when not touching, else 0
};

/// @param vertices  (3 x V) of the body, in the frame of the capsules
[[nodiscard]] ContactTruth contact_truth(std::span<const Capsule> hand,
                                         const Eigen::Matrix3Xd& vertices);

/// Vertices of the body inside the hand, in increasing order.
[[nodiscard]] std::vector<int> vertices_inside(std::span<const Capsule> hand,
                                               const Eigen::Matrix3Xd& vertices);

}  // namespace palpable
