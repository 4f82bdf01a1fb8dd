#include "palpable/live/track/picture_shift.h"

#include <algorithm>
#include <utility>

namespace palpable {

double picture_shift_px(const TrackCamera& camera, double depth, const Rigid3& a_from_world,
                        const Rigid3& b_from_world) {
  const Rigid3 b_from_a = b_from_world * a_from_world.inverse(Eigen::Isometry);
  double most = 0;
  for (const auto& [u, v] : {std::pair{0.5, 0.5}, {0.2, 0.2}, {0.8, 0.2}, {0.2, 0.8}, {0.8, 0.8}}) {
    const Eigen::Vector2d uv(u * camera.camera.width, v * camera.camera.height);
    const Eigen::Vector3d x = b_from_a * camera.camera.unproject(uv.x(), uv.y(), depth);
    if (x.z() < kNearestSeen) return 1e9;
    most = std::max(most, (camera.camera.project(x) - uv).norm());
  }
  return most;
}

}  // namespace palpable
