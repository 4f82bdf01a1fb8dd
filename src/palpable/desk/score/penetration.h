/// @file
/// How deep a real hand reaches into the drawn body, which should have been deformed by it.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <span>

namespace palpable {

/// Depth of the deepest sample of the triangles (deepest_sample.h) inside the capsules, m; 0 when
/// no sample is inside.
/// @param surface  m, in the same frame as the capsules
[[nodiscard]] double deepest_penetration(const SurfaceMesh& surface,
                                         std::span<const Capsule> capsules);

}  // namespace palpable
