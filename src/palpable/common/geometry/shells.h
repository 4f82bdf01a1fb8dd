/// @file
/// The shells of a surface, which are its closed connected parts, and how they are nested: a body,
/// its cavities, islands in them.
///
///   +----------------+     outer shell, triangles face outwards:  volume > 0
///   |   +------+     |     cavity, triangles face into it:        volume < 0
///   |   |      |     |     the winding number is 1 in the material, 0 outside and in
///   |   +------+     |     the cavity
///   +----------------+
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace palpable {

/// The parts of a surface that are connected through common vertices, in the order of their first
/// triangle. @pre triangles index existing vertices
/// @returns for each shell its triangles, increasing
[[nodiscard]] std::vector<std::vector<int>> shells_of(const SurfaceMesh& surface);

/// The surface of some of a surface's triangles; vertices keep their order.
[[nodiscard]] SurfaceMesh surface_of(const SurfaceMesh& surface, const std::vector<int>& triangles);

/// How often a closed surface winds around a point that is not on it: the sum of the triangles'
/// solid angles, seen from the point, over 4 pi (van Oosterom and Strackee 1983). A shell around
/// the point adds 1 if its triangles face away from the point, and -1 if they face it. O(M).
[[nodiscard]] double winding_number(const SurfaceMesh& surface, const Eigen::Vector3d& point);

/// Describes an error in the nesting of a closed surface's shells, its position and the remedy: a
/// shell in the material that does not face into a cavity, or one outside of all others that faces
/// inwards. Empty if there is none. @pre check_watertight() finds nothing; shells do not cross
[[nodiscard]] std::string misplaced_shell(const SurfaceMesh& surface);

/// A point in each cavity, away from its walls. @pre misplaced_shell() finds nothing
[[nodiscard]] std::vector<Eigen::Vector3d> points_in_cavities(const SurfaceMesh& surface);

}  // namespace palpable
