#include "palpable/touch/carried_skin.h"

#include "palpable/geometry/surface_distance.h"

#include <array>

namespace palpable {

CarriedSkin::CarriedSkin(const SurfaceMesh& coarse, const Eigen::Matrix3Xd& places,
                         const Eigen::Matrix3Xd& normals) {
  const SurfaceDistance surface(coarse);
  Eigen::Matrix3Xd coarse_normals(3, coarse.vertex_count());
  vertex_normals(coarse.vertices, coarse.triangles, coarse_normals);
  points_.reserve(static_cast<std::size_t>(places.cols()));
  for (Eigen::Index p = 0; p < places.cols(); ++p) {
    const NearestOnSurface at = surface.nearest_facing(places.col(p), normals.col(p));
    const auto corners = coarse.triangles.col(at.triangle);
    CarriedPoint point;
    point.on.corners = {corners[0], corners[1], corners[2]};
    point.on.weights = at.weights.cast<float>();
    const Eigen::Vector3d along = (coarse_normals(Eigen::all, corners) * at.weights).normalized();
    point.height = static_cast<float>(along.dot(places.col(p) - at.point));
    points_.push_back(point);
  }
}

}  // namespace palpable
