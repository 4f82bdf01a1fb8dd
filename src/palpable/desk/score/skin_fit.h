/// @file
/// Whether two skins at rest are of one body, however finely each of them is meshed.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

namespace palpable {

/// How far the one skin lies off the other, m: the mean distance of a vertex, weighted by its area,
/// to the nearest point of the other skin; the larger one of the two directions. So what one of
/// them lacks counts, too.
/// @param a, b  m, one frame, each with at least one triangle
[[nodiscard]] double skin_offset(const SurfaceMesh& a, const SurfaceMesh& b);

}  // namespace palpable
