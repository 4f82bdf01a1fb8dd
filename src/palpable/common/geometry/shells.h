/// @file
/// The closed parts of a surface, and how they lie in each other: a body, its cavities, islands in
/// them.
///
///   +----------------+     outer shell, triangles face outwards:  volume > 0
///   |   +------+     |     cavity, triangles face into it:        volume < 0
///   |   |      |     |     a point in the material is wound round once, one outside or in a
///   |   +------+     |     cavity not at all
///   +----------------+
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace palpable {

/// The parts of a surface that hang together through common vertices, in the order of their first
/// triangle. @pre triangles index existing vertices
/// @returns for each shell its triangles, increasing
[[nodiscard]] std::vector<std::vector<int>> shells_of(const SurfaceMesh& surface);

/// Some triangles of a surface as a surface; vertices keep their order.
[[nodiscard]] SurfaceMesh surface_of(const SurfaceMesh& surface, const std::vector<int>& triangles);

/// How often a closed surface winds round a point that is not on it, once for each shell outside of
/// which all triangles face away from the point (van Oosterom and Strackee 1983: the sum of
/// the triangles' solid angles over 4 pi). O(M).
[[nodiscard]] double winding_number(const SurfaceMesh& surface, const Eigen::Vector3d& point);

/// What is wrong with how the shells of a closed surface lie in each other, where, and what to do:
/// a shell in the material that does not face into a cavity, or one outside of all others that
/// faces inwards. Empty: nothing. @pre check_watertight() finds nothing; shells do not cross
[[nodiscard]] std::string misplaced_shell(const SurfaceMesh& surface);

/// A point in each cavity, away from its walls. @pre misplaced_shell() finds nothing
[[nodiscard]] std::vector<Eigen::Vector3d> points_in_cavities(const SurfaceMesh& surface);

}  // namespace palpable
