/// @file
/// The data of the virtual body that a script needs: its surface and its sites. Hands press the
/// body, but the camera does not see it.
///
/// Desk frame, m: X to the right as seen by the first camera, Y away from it, Z up. The desk's top
/// is Z = 0, and the body stands round the Z axis.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <vector>

namespace palpable {

/// The undeformed body in its own frame.
struct DeskBody {
  SurfaceMesh surface;
  std::vector<int> site_vertices;  ///< (S) vertices at which loads act
  Eigen::Matrix3Xd directions;     ///< (3 x S) unit, directions of the loads, into the body
};

/// Sample points of a surface, dense enough that neither finger nor pencil passes between them.
struct SurfacePoints {
  Eigen::Matrix3Xd points;   ///< (3 x P) m
  Eigen::Matrix3Xd inwards;  ///< (3 x P) unit normals, into the body
};

/// Samples a surface: first its vertices, then points inside the triangles and on their edges.
/// @param spacing  m, > 0, largest distance of a point of the surface from the nearest sample
[[nodiscard]] SurfacePoints sample_surface(const SurfaceMesh& surface, double spacing);

/// The same points in another frame.
[[nodiscard]] SurfacePoints transformed(const SurfacePoints& points, const Rigid3& transform);

/// The site whose vertex is nearest to a point of the body frame; -1 for a body without sites.
[[nodiscard]] int nearest_site(const DeskBody& body, const Eigen::Vector3d& x_in_body);

}  // namespace palpable
