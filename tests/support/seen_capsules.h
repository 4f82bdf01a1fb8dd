/// @file
/// Depth images of capsules by an ideal camera: images with an analytic truth, for tests.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"

#include <Eigen/Core>

#include <algorithm>
#include <limits>
#include <vector>

namespace palpable::test {

/// All points within `radius` of the segment a-b, m; a ball if a == b.
struct Capsule {
  Eigen::Vector3d a, b;
  double radius;

  /// Signed distance, m.
  [[nodiscard]] double distance(const Eigen::Vector3d& x) const {
    const Eigen::Vector3d ab = b - a;
    const double length2 = ab.squaredNorm();
    const double t = length2 > 0 ? std::clamp((x - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
    return (x - a - t * ab).norm() - radius;
  }
};

inline double distance_to(const std::vector<Capsule>& capsules, const Eigen::Vector3d& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& capsule : capsules) least = std::min(least, capsule.distance(x));
  return least;
}

/// Z of the nearest capsule per pixel (NaN: none), found by sphere tracing to 10 um. Capsules are
/// in the camera frame.
inline DepthImage depth_of(const std::vector<Capsule>& capsules, const PinholeCamera& camera,
                           double farthest = 2.0) {
  DepthImage depth(camera.width, camera.height, std::numeric_limits<float>::quiet_NaN());
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = camera.unproject(u, v, 1.0);
      const double length = ray.norm();
      double z = 0.05;
      for (int i = 0; i < 200 && z < farthest; ++i) {
        const double d = distance_to(capsules, z * ray);
        if (d < 1e-5) {
          depth(u, v) = static_cast<float>(z);
          break;
        }
        z += d / length;
      }
    }
  }
  return depth;
}

}  // namespace palpable::test
