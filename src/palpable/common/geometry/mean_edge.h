/// @file
/// The mean edge length of a surface.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

namespace palpable {

/// Mean length of the edges, m. @throws ContractViolation for a surface without triangles
[[nodiscard]] double mean_edge_length(const SurfaceMesh& surface);

}  // namespace palpable
