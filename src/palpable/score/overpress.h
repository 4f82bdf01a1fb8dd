/// @file
/// How far a drawn body has given way beyond what the object demands.
///
///   N  vertices of the true skin
#pragma once

#include <Eigen/Core>

namespace palpable {

/// m around the touched point that belong to the touched place.
inline constexpr double kTouchedPlace = 0.010;

/// How much farther than the true skin the drawn one has moved away, at the touched place, m:
///
///     max over the place of (found - truth) . d,   at least 0,
///
/// where the place are the vertices that lie within kTouchedPlace of `touched` at rest (at least
/// the nearest one) and d is the direction in which the true skin moves there on average. A body
/// that flees before the hand is not penetrated; this is the figure that shows it.
/// @param rest          (3 x N) m, vertices of the true skin at rest
/// @param truth, found  (3 x N) m, displacements of these vertices
/// @param touched       m, on the skin at rest
/// @throws ContractViolation when they are not of one skin
[[nodiscard]] double overpress(const Eigen::Matrix3Xd& rest, const Eigen::Matrix3Xd& truth,
                               const Eigen::Matrix3Xd& found, const Eigen::Vector3d& touched);

}  // namespace palpable
