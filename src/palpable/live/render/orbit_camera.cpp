#include "palpable/live/render/orbit_camera.h"

#include <algorithm>
#include <cmath>

namespace palpable {

Eigen::Vector3d OrbitCamera::eye() const {
  return target + distance * Eigen::Vector3d(std::sin(azimuth) * std::cos(elevation),
                                             -std::cos(azimuth) * std::cos(elevation),
                                             std::sin(elevation));
}

Rigid3 OrbitCamera::camera_from_body() const {
  const Eigen::Vector3d forward = (target - eye()).normalized();
  const Eigen::Vector3d right(std::cos(azimuth), std::sin(azimuth), 0.0);
  Rigid3 body_from_camera = Rigid3::Identity();
  body_from_camera.linear() << right, forward.cross(right), forward;
  body_from_camera.translation() = eye();
  return body_from_camera.inverse();
}

void OrbitCamera::turn(double dx_px, double dy_px) {
  constexpr double kRadPerPx = 0.008;
  azimuth = std::remainder(azimuth - kRadPerPx * dx_px, 2.0 * std::acos(-1.0));
  elevation = std::clamp(elevation + kRadPerPx * dy_px, 0.02, kSteepest);
}

void OrbitCamera::zoom(double steps, double usual_distance) {
  distance = std::clamp(distance * std::pow(0.9, steps), usual_distance / 8, usual_distance * 8);
}

PinholeCamera camera_of_view(int width, int height, double vertical_view_rad) {
  const double f = 0.5 * height / std::tan(0.5 * vertical_view_rad);
  return {width, height, f, f, 0.5 * (width - 1), 0.5 * (height - 1)};
}

}  // namespace palpable
