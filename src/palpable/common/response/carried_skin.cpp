#include "palpable/common/response/carried_skin.h"

namespace palpable {

Carrier::Carrier(const SurfaceMesh& coarse) : surface_(coarse), normals_(3, coarse.vertex_count()) {
  vertex_normals(coarse.vertices, coarse.triangles, normals_);
}

CarriedPoint Carrier::stand(const Eigen::Vector3d& place, const Eigen::Vector3d& normal) const {
  const NearestOnSurface at = surface_.nearest_facing(place, normal);
  const auto corners = surface_.surface().triangles.col(at.triangle);
  CarriedPoint point;
  point.on.corners = {corners[0], corners[1], corners[2]};
  point.on.weights = at.weights.cast<float>();
  const Eigen::Vector3d along = (normals_(Eigen::all, corners) * at.weights).normalized();
  point.height = static_cast<float>(along.dot(place - at.point));
  return point;
}

}  // namespace palpable
