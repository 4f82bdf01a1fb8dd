/// @file
/// Whether two skins at rest belong to the same body, independently of their mesh resolution.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

namespace palpable {

/// Mean distance between two skins, m: the area-weighted mean distance of the vertices of one skin
/// to the nearest point of the other. The larger value of the two directions is returned, so that a
/// part missing in either skin counts.
/// @param a, b  m, in the same frame, each with at least one triangle
[[nodiscard]] double skin_offset(const SurfaceMesh& a, const SurfaceMesh& b);

}  // namespace palpable
