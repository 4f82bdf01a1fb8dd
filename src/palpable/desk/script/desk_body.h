/// @file
/// What a script needs of the virtual body: its surface and where it may be pressed. Hands press
/// it, but the camera never sees it.
///
/// Desk frame: metres; X to the right as the first camera sees it, Y away from it, Z up; the desk
/// is Z = 0 and the body stands round the Z axis.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <vector>

namespace palpable {

/// The undeformed body in its own frame.
struct DeskBody {
  SurfaceMesh surface;
  std::vector<int> site_vertices;  ///< (S) vertices at which loads act
  Eigen::Matrix3Xd directions;     ///< (3 x S) unit, of the loads: into the body
};

/// Points of a surface, dense enough that neither finger nor pencil passes between them.
struct SurfacePoints {
  Eigen::Matrix3Xd points;   ///< (3 x P) m
  Eigen::Matrix3Xd inwards;  ///< (3 x P) unit, of the triangle: into the body
};

/// The vertices, then points within the triangles and on their edges.
/// @param spacing  m, > 0: no point of the surface is farther away from the nearest sample
[[nodiscard]] SurfacePoints sample_surface(const SurfaceMesh& surface, double spacing);

/// The same points in another frame.
[[nodiscard]] SurfacePoints transformed(const SurfacePoints& points, const Rigid3& transform);

/// The site whose vertex is nearest to a point of the body frame; -1 for a body without sites.
[[nodiscard]] int nearest_site(const DeskBody& body, const Eigen::Vector3d& x_in_body);

}  // namespace palpable
