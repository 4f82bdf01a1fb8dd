#include "palpable/common/geometry/stamped_pose.h"

#include <algorithm>
#include <cmath>

namespace palpable {

std::optional<Rigid3> pose_nearest(const std::vector<StampedPose>& path, double time,
                                   double within) {
  if (path.empty()) return std::nullopt;
  const auto after = std::lower_bound(path.begin(), path.end(), time,
                                      [](const StampedPose& p, double t) { return p.time < t; });
  const StampedPose* nearest = after == path.end() ? &path.back() : &*after;
  if (after != path.begin() && time - (after - 1)->time < std::abs(nearest->time - time)) {
    nearest = &*(after - 1);
  }
  if (std::abs(nearest->time - time) > within) return std::nullopt;
  return nearest->world_from_camera;
}

}  // namespace palpable
