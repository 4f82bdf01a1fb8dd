/// @file
/// How deep a real hand is left inside the body that should have given way to it.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <span>

namespace palpable {

/// How deep the deepest sample of the triangles (deepest_sample.h) lies inside the capsules, m; 0
/// when none is inside.
/// @param surface  m, in the frame of the capsules
[[nodiscard]] double deepest_penetration(const SurfaceMesh& surface,
                                         std::span<const Capsule> capsules);

}  // namespace palpable
