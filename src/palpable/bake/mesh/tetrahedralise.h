/// @file
/// Filling a surface with tetrahedra (TetGen).
#pragma once

#include "palpable/common/geometry/tet_mesh.h"

#include <optional>
#include <string>

namespace palpable {

/// Shape of the tetrahedra of a mesh, for reports.
struct TetQuality {
  double smallest_dihedral_degrees = 0;  ///< angle between two faces; 70.5 in a regular one
  double largest_dihedral_degrees = 0;
  double volume = 0;  ///< m^3
};

/// Fills the solid that `surface` encloses. The surface is kept as it is, triangle for triangle, so
/// boundary_of() the result is the surface again; nodes are added inside only, until radius to edge
/// ratios are below 1.3 (where the surface allows it) and volumes suit the surface's own mean edge
/// length. Cavities stay empty. Deterministic. TetGen runs in a child process (tetgen_process.h).
///
/// @param name        what to call the surface in messages
/// @param inner_edge  m, edge far from the surface; none: the surface's mean edge
/// @throws Error as require_solid_surface(), require_gaps() and require_meshable(); with the place
///         of the thinnest triangle when TetGen gives up; when the tetrahedra do not have the
///         volume of the surface
[[nodiscard]] TetMesh tetrahedralise(const SurfaceMesh& surface, const std::string& name,
                                     std::optional<double> inner_edge = std::nullopt);

[[nodiscard]] TetQuality quality_of(const TetMesh& mesh);

}  // namespace palpable
