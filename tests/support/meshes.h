/// @file
/// Surfaces derived from other surfaces.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

namespace palpable::test {

inline SurfaceMesh joined(const SurfaceMesh& a, const SurfaceMesh& b) {
  SurfaceMesh both;
  both.vertices.resize(3, a.vertex_count() + b.vertex_count());
  both.vertices << a.vertices, b.vertices;
  both.triangles.resize(3, a.triangle_count() + b.triangle_count());
  both.triangles << a.triangles, (b.triangles.array() + a.vertex_count()).matrix();
  return both;
}

/// Reverses the orientation: a shell becomes a cavity.
inline SurfaceMesh flipped(SurfaceMesh surface) {
  surface.triangles.row(0).swap(surface.triangles.row(1));
  return surface;
}

}  // namespace palpable::test
