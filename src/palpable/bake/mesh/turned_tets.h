/// @file
/// Tetrahedra whose corners a program orders the other way round.
#pragma once

#include "palpable/common/geometry/tet_mesh.h"

namespace palpable {

/// Swaps two corners (and the middles of their edges) of each tetrahedron with a negative volume,
/// if it is only its order that differs: the mesh then has no face that is shared by two tetrahedra
/// which lie on the same side of it, as it has where one is folded over.
/// @returns how many were turned; 0, and nothing is changed, where one is folded over or flat, or a
///          face belongs to more than two
int turn_inverted(TetMesh& mesh);

}  // namespace palpable
