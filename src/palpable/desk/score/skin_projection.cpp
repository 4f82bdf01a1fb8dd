#include "palpable/desk/score/skin_projection.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/surface_distance.h"

namespace palpable {

SkinProjection::SkinProjection(const SurfaceMesh& from, const Eigen::Matrix3Xd& to)
    : from_count_(from.vertices.cols()) {
  PALPABLE_EXPECT(from.triangle_count() > 0, "a skin has triangles");
  corners_.resize(3, to.cols());
  weights_.resize(3, to.cols());
  const SurfaceDistance skin(from);
  for (Eigen::Index v = 0; v < to.cols(); ++v) {
    const NearestOnSurface nearest = skin.nearest(to.col(v));
    corners_.col(v) = from.triangles.col(nearest.triangle);
    weights_.col(v) = nearest.weights;
  }
}

Eigen::Matrix3Xd SkinProjection::vectors(const Eigen::Matrix3Xd& field) const {
  PALPABLE_EXPECT(field.cols() == from_count_, "one vector per vertex of the skin");
  Eigen::Matrix3Xd projected(3, corners_.cols());
  for (Eigen::Index v = 0; v < corners_.cols(); ++v) {
    projected.col(v) = field(Eigen::all, corners_.col(v)) * weights_.col(v);
  }
  return projected;
}

Eigen::VectorXd SkinProjection::numbers(const Eigen::VectorXd& field) const {
  PALPABLE_EXPECT(field.size() == from_count_, "one number per vertex of the skin");
  Eigen::VectorXd projected(corners_.cols());
  for (Eigen::Index v = 0; v < corners_.cols(); ++v) {
    projected[v] = field(corners_.col(v)).dot(weights_.col(v));
  }
  return projected;
}

}  // namespace palpable
