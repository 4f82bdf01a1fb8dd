/// @file
/// How much farther a drawn body is deformed than the obstacle requires.
///
///   N  vertices of the true skin
#pragma once

#include <Eigen/Core>

#include <span>

namespace palpable {

/// Excess of the drawn displacement over the true one at the touched places, m:
///
///     max over the places p, max over the vertices v of p, of (found_v - truth_v) . d_p,
///     at least 0
///
/// The vertices of a place are those within kTouchedPlace (touched_places.h) of a touched point at
/// rest, at least the nearest one. d_p is the mean direction of their true displacements; each
/// place has its own because a finger and a thumb push in different directions. The penetration
/// does not show a body that deforms too much, since it then stays clear of the hand; this figure
/// does.
/// @param rest          (3 x N) m, vertices of the true skin at rest
/// @param truth, found  (3 x N) m, displacements of these vertices
/// @param touched       m, on the skin at rest, one point per place
/// @throws ContractViolation when the sizes differ, or nothing is touched
[[nodiscard]] double overpress(const Eigen::Matrix3Xd& rest, const Eigen::Matrix3Xd& truth,
                               const Eigen::Matrix3Xd& found,
                               std::span<const Eigen::Vector3d> touched);

}  // namespace palpable
