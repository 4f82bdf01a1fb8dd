/// @file
/// Bodies used by several verification tests.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <cmath>

namespace palpable::test {

/// A ball of 4 cm radius with two ears: thin parts that bend beside a thick part that is squeezed.
/// @param subdivisions  of the icosahedron from which the sphere is made
inline SurfaceMesh ball_with_ears(int subdivisions) {
  using Eigen::Vector3d;
  const double R = 0.04;
  SurfaceMesh surface = sphere_surface({0, 0, 0}, 1.0, subdivisions);
  const Vector3d left = Vector3d(0.5, 0.1, 1).normalized(),
                 right = Vector3d(-0.5, -0.1, 1).normalized();
  for (int v = 0; v < surface.vertex_count(); ++v) {
    const Vector3d n = surface.vertices.col(v).normalized();
    const auto ear = [&](const Vector3d& axis) {
      return std::exp(-(n - axis).squaredNorm() / (0.3 * 0.3));
    };
    surface.vertices.col(v) = R * (1.0 + 0.7 * (ear(left) + ear(right))) * n;
  }
  return surface;
}

}  // namespace palpable::test
