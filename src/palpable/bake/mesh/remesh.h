/// @file
/// Remeshes triangle surfaces to an even edge length, before they are filled (CGAL's isotropic
/// remeshing).
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <string>

namespace palpable {

/// Refuses a surface that does not enclose a solid.
/// @param name  what to call it in the message, e.g. the file
/// @throws Error if the surface is not watertight, two sheets meet in a single vertex, triangles
///         pass through each other (of one closed shell, or of two that overlap), or a shell lies
///         wrongly in others (misplaced_shell()): what, where, and what to do
void require_solid_surface(const SurfaceMesh& surface, const std::string& name);

/// A surface over the same shape whose edges are about `edge_length` long. Vertices stay on the
/// given surface; edges sharper than 80 degrees are kept if keep_sharp_edges (those of a wrap are
/// only creases and need not be). Where the sides of a thin part would intersect, edges are
/// shortened to as little as a quarter. Deterministic.
/// @param edge_length  m, > 0
/// @param name         for messages
/// @throws Error as require_solid_surface(), for the result too: an edge length too coarse for thin
///         parts makes their sides meet; as require_meshable() and require_same_volume()
[[nodiscard]] SurfaceMesh remesh_surface(const SurfaceMesh& surface, double edge_length,
                                         const std::string& name, bool keep_sharp_edges = true);

/// A closed surface around triangles that may have holes, pass through each other or be unconnected
/// (CGAL's alpha wrapping): the surface that a ball of diameter `size` rolling outside can reach.
/// It lies `size` / 7 outside of what it wraps; hollows and holes narrower than `size` are bridged.
/// Triangles are of all sizes: remesh_surface() comes next. Deterministic.
/// @param size  m, > 0
/// @param name  for messages
/// @throws Error for a surface without triangles, and as require_wrappable()
[[nodiscard]] SurfaceMesh wrap_surface(const SurfaceMesh& surface, double size,
                                       const std::string& name);

}  // namespace palpable
