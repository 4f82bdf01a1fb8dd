#include "palpable/track/landmark_map.h"

#include <algorithm>

namespace palpable {

Eigen::Matrix2d image_from_anchor(const TrackCamera& camera, const Landmark& landmark,
                                  const Rigid3& anchor_from_world,
                                  const Rigid3& camera_from_world) {
  constexpr double kStep = 4;  // px: the middle of the patch
  const Rigid3 camera_from_anchor = camera_from_world * anchor_from_world.inverse(Eigen::Isometry);
  const double w = 1 / (anchor_from_world * landmark.x_in_world).z();
  const auto seen = [&](double du, double dv) -> Eigen::Vector2d {
    // A surface that turns away is not followed beyond half of its depth.
    const double inverse = std::max(w + landmark.slope.dot(Eigen::Vector2d(du, dv)), 0.5 * w);
    const Eigen::Vector3d x =
        camera.camera.unproject(landmark.uv.x() + du, landmark.uv.y() + dv, 1 / inverse);
    return camera.camera.project(camera_from_anchor * x);
  };
  const Eigen::Vector2d at = seen(0, 0);
  Eigen::Matrix2d A;
  A.col(0) = (seen(kStep, 0) - at) / kStep;
  A.col(1) = (seen(0, kStep) - at) / kStep;
  return A;
}

}  // namespace palpable
