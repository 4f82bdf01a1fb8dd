/// @file
/// Joins vertices of a surface that differ by rounding.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

namespace palpable {

struct VertexWeld {
  int welded = 0;      ///< vertices joined with another one
  double moved = 0.0;  ///< the longest way that one was moved, in the unit of the vertices
};

/// Joins vertices on open edges with a vertex that is nearer than 1e-4 of the mean edge at either
/// of them, and than a tenth of the shortest, so that no triangle collapses. The earlier vertex
/// stays where it is. Unused vertices are dropped if any are joined; otherwise nothing changes.
/// O(N log N). @pre triangles index existing vertices
VertexWeld weld_open_vertices(SurfaceMesh& surface);

}  // namespace palpable
