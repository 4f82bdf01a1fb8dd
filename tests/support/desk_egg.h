/// @file
/// An egg that stands on the synthetic desk, for tests of its sequences.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/desk/script/desk_body.h"

#include <Eigen/Core>

#include <cstddef>

namespace palpable::test {

/// 0.13 m high; every 41st vertex is a site, at which the egg is pressed towards its centre.
/// @param half_width  m, along X; along Y it is 0.055
inline DeskBody desk_egg(double half_width = 0.045) {
  DeskBody body;
  body.surface = sphere_surface({0, 0, 0}, 1.0, 4);
  const Eigen::Vector3d middle(0.0, 0.0, 0.065);
  body.surface.vertices =
      (Eigen::Vector3d(half_width, 0.055, 0.065).asDiagonal() * body.surface.vertices).colwise() +
      middle;
  for (int v = 0; v < body.surface.vertex_count(); v += 41) body.site_vertices.push_back(v);
  body.directions.resize(3, static_cast<Eigen::Index>(body.site_vertices.size()));
  for (std::size_t s = 0; s < body.site_vertices.size(); ++s) {
    body.directions.col(static_cast<Eigen::Index>(s)) =
        (middle - body.surface.vertices.col(body.site_vertices[s])).normalized();
  }
  return body;
}

}  // namespace palpable::test
