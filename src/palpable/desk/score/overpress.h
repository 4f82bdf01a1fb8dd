/// @file
/// How far a drawn body has given way beyond what the object demands.
///
///   N  vertices of the true skin
#pragma once

#include <Eigen/Core>

#include <span>

namespace palpable {

/// How much farther than the true skin the drawn one has moved away, at the touched places, m:
///
///     max over the places, max over a place, of (found - truth) . d,   at least 0,
///
/// where a place are the vertices that lie within kTouchedPlace (touched_places.h) of a touched
/// point at rest (at least the nearest one) and d is the direction in which the true skin moves
/// there on average. A body that flees before the hand is not penetrated; this is the figure that
/// shows it. Finger and thumb push two ways, so each place has its own d.
/// @param rest          (3 x N) m, vertices of the true skin at rest
/// @param truth, found  (3 x N) m, displacements of these vertices
/// @param touched       m, on the skin at rest, a point for each place
/// @throws ContractViolation when they are not of one skin, or nothing is touched
[[nodiscard]] double overpress(const Eigen::Matrix3Xd& rest, const Eigen::Matrix3Xd& truth,
                               const Eigen::Matrix3Xd& found,
                               std::span<const Eigen::Vector3d> touched);

}  // namespace palpable
