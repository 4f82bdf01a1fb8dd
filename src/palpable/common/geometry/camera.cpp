#include "palpable/common/geometry/camera.h"

namespace palpable {

Eigen::Vector2d DistortedCamera::project(const Eigen::Vector3d& x_in_camera) const {
  const auto [k1, k2, p1, p2, k3] = distortion;
  const double x = x_in_camera.x() / x_in_camera.z();
  const double y = x_in_camera.y() / x_in_camera.z();
  const double r2 = x * x + y * y;
  // Brown-Conrady: radial factor, then the tangential part of a lens that is not centred.
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double x_d = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const double y_d = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  return {pinhole.fx_px * x_d + pinhole.cx_px, pinhole.fy_px * y_d + pinhole.cy_px};
}

}  // namespace palpable
