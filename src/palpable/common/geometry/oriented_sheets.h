/// @file
/// Makes the triangles of closed surfaces face outwards.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

namespace palpable {

/// Reverses triangles so that those of each closed part (connected through edges) are wound alike
/// and outermost parts face outwards.
///
///   wound both ways                          outwards, or inwards within an odd number of others
///   wound alike, outermost, facing inwards   outwards
///   wound alike, within another one          as that one: turned with it, or left
///
/// @returns how many triangles were reversed; 0 where an edge does not have exactly two triangles,
/// a
///          part encloses no volume, or one has a single side (a Klein bottle)
/// @pre triangles index existing vertices
int turn_outwards(SurfaceMesh& surface);

}  // namespace palpable
