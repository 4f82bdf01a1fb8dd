/// @file
/// Checks before and after meshing: how many nodes a mesh will have, and whether the result is
/// still the same solid.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <string>

namespace palpable {

/// Largest number of nodes of a body. With more, the solver's factor would not fit into the memory
/// of a workstation (some 10 kB per node), and the mesher needs nearly as much.
inline constexpr double kMostNodes = 2e6;

/// Refuses points of which a single one makes the bounding box a thousand times larger: the file is
/// damaged.
/// @param points  (3 x N), of any unit
/// @param name    what to call them in messages
/// @throws Error that names the point
void require_no_stray(const Eigen::Matrix3Xd& points, const std::string& name);

/// Estimated number of nodes of a tetrahedral mesh with edge e in a solid of surface area A and
/// volume V:
///
///     1.15 A / e^2 + 1.35 V / e^3
///
/// An even triangulation has one vertex for sqrt(3)/2 e^2 of surface, a packing of tetrahedra one
/// for e^3 / sqrt(2) of volume; fitted to remesh_surface() and tetrahedralise() of balls, boxes and
/// the bunny: at most 20 % too low, for plates of few layers up to 60 % too high.
/// @param inner_edge  m, of edges inside; `edge` is of those on the surface
[[nodiscard]] double estimated_nodes(const SurfaceMesh& surface, double edge, double inner_edge);

/// @throws Error that names the edge that would do, for more than kMostNodes nodes
/// @param name  what to call the surface in messages
void require_meshable(const SurfaceMesh& surface, double edge, double inner_edge,
                      const std::string& name);

/// The same for wrap_surface(), for any set of triangles. Triangles that others hide count, too.
/// @throws Error that names the size that would do
void require_wrappable(const SurfaceMesh& surface, double size, const std::string& name);

/// Refuses a solid whose volume changed while it was meshed: |V - V0| / V0 above
///
///     0.01 + min(0.5 (e / r)^2, 0.1),     r = 3 V0 / A
///
/// Flat triangles of edge e between the points of a ball of radius r lose 3/8 (e / r)^2 of it; r is
/// the radius of a ball, and a measure of thickness for other shapes. A solid that loses more than
/// a tenth to its facets counts as another body.
/// @param before  encloses V0
/// @param edge    m, e: the requested edge
/// @throws Error that names both volumes
void require_same_volume(const SurfaceMesh& before, double volume, double edge,
                         const std::string& name);

/// Refuses shells so close to each other that a mesh between them cannot be made.
/// @throws Error with the place of the gap, where a vertex is nearer to another shell than 1e-7 of
///         the surface's diagonal
void require_gaps(const SurfaceMesh& surface, const std::string& name);

}  // namespace palpable
