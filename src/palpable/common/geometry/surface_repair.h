/// @file
/// Mechanical repairs of a surface: those whose result a figure proves to be the same solid.
///
///   corners apart by rounding      welded                     the farthest way that one moved
///   a face that is there twice     once                       how many
///   faces wound the other way      turned outwards            the volume that they enclose
///
/// Holes, faces that pass through each other and edges of more than two faces are none of these:
/// what the solid is there must be decided by a person, or by wrap_surface().
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <string>

namespace palpable {

/// What repair_surface() changed; lengths are those of the surface's vertices.
struct SurfaceRepair {
  int welded = 0;       ///< vertices joined with another one
  double moved = 0.0;   ///< the longest way that a vertex was moved
  int collapsed = 0;    ///< triangles left out, of which two corners are one vertex
  int duplicates = 0;   ///< triangles left out that have the corners of an earlier one
  int turned = 0;       ///< triangles whose orientation was reversed
  int triangles = 0;    ///< of the result
  double volume = 0.0;  ///< that the result encloses, if any triangle was turned

  /// The changes and their figures in one line; empty if there were none.
  [[nodiscard]] std::string describe() const;
};

/// Repairs a surface. A surface that check_watertight() accepts and whose outermost shells face
/// outwards stays as it is, bit for bit.
///
/// Welded are vertices on open edges with one that is nearer than 1e-4 of the mean edge at either
/// of them (and than a tenth of the shortest); the first one in the file stays where it is. Of
/// faces with the same corners one is kept if that closes the surface; otherwise those that are
/// wound alike. Triangles are turned only where every edge has two triangles: a shell whose
/// triangles are wound both ways is made to face outwards, or inwards as a cavity where it lies in
/// an odd number of others; an outermost one that faces inwards is turned together with all
/// shells within it. O(M log M), and M for each shell that lies in another's box.
/// @pre triangles index existing vertices
SurfaceRepair repair_surface(SurfaceMesh& surface);

}  // namespace palpable
