#include "palpable/desk/film/lens.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace palpable {

Eigen::Vector2d undistorted_ray(const DistortedCamera& camera, const Eigen::Vector2d& pixel) {
  const auto [k1, k2, p1, p2, k3] = camera.distortion;
  const PinholeCamera& c = camera.pinhole;
  const Eigen::Vector2d wanted((pixel.x() - c.cx_px) / c.fx_px, (pixel.y() - c.cy_px) / c.fy_px);
  Eigen::Vector2d ray = wanted;
  for (int step = 0; step < 20; ++step) {
    const double x = ray.x();
    const double y = ray.y();
    const double r2 = x * x + y * y;
    const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double slope = k1 + r2 * (2.0 * k2 + 3.0 * k3 * r2);  // d radial / d r2
    const Eigen::Vector2d error(
        x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x) - wanted.x(),
        y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y - wanted.y());
    Eigen::Matrix2d J;
    J(0, 0) = radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x;
    J(0, 1) = 2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y;
    J(1, 0) = J(0, 1);
    J(1, 1) = radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x;
    const Eigen::Vector2d change = J.inverse() * error;
    ray -= change;
    if (change.norm() < 1e-12) return ray;
  }
  PALPABLE_EXPECT(ray.allFinite(), "the pixel lies where the lens has an inverse");
  return ray;
}

PinholeCamera ideal_camera_for(const DistortedCamera& camera, double focal_px) {
  const int w = camera.pinhole.width;
  const int h = camera.pinhole.height;
  // The extreme rays belong to pixels at the border of the picture. The filter needs two more
  // pixels on each side.
  double left = 0, right = 0, top = 0, bottom = 0;
  const auto include = [&](double u, double v) {
    const Eigen::Vector2d ray = undistorted_ray(camera, {u, v});
    left = std::min(left, ray.x());
    right = std::max(right, ray.x());
    top = std::min(top, ray.y());
    bottom = std::max(bottom, ray.y());
  };
  for (int u = 0; u < w; ++u) {
    include(u, 0);
    include(u, h - 1);
  }
  for (int v = 0; v < h; ++v) {
    include(0, v);
    include(w - 1, v);
  }
  PinholeCamera ideal;
  ideal.fx_px = ideal.fy_px = focal_px;
  ideal.cx_px = std::ceil(-left * focal_px) + 2.0;
  ideal.cy_px = std::ceil(-top * focal_px) + 2.0;
  ideal.width = static_cast<int>(std::ceil(ideal.cx_px + right * focal_px)) + 3;
  ideal.height = static_cast<int>(std::ceil(ideal.cy_px + bottom * focal_px)) + 3;
  return ideal;
}

std::vector<Eigen::Vector2f> distortion_map(const DistortedCamera& camera,
                                            const PinholeCamera& ideal) {
  const int w = camera.pinhole.width;
  const int h = camera.pinhole.height;
  std::vector<Eigen::Vector2f> map;
  map.reserve(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  for (int v = 0; v < h; ++v)
    for (int u = 0; u < w; ++u) {
      const Eigen::Vector2d ray = undistorted_ray(camera, {u, v});
      map.emplace_back(static_cast<float>(ideal.fx_px * ray.x() + ideal.cx_px),
                       static_cast<float>(ideal.fy_px * ray.y() + ideal.cy_px));
    }
  return map;
}

std::vector<float> depth_where_seen(const std::vector<Eigen::Vector2f>& map,
                                    const PinholeCamera& ideal, int margin) {
  const int w = ideal.width;
  const int h = ideal.height;
  std::vector<float> depth(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0.0F);
  for (const Eigen::Vector2f& at : map) {
    const int i = static_cast<int>(at.y()) * w + static_cast<int>(at.x());
    for (const int texel : {i, i + 1, i + w, i + w + 1}) depth[texel] = 1.0F;
  }
  // Marks up to `margin` pixels next to marked ones, in a row (step 1) or in a column (step w).
  const auto widen = [&](int start, int count, int step) {
    const auto pass = [&](int first, int stride) {
      int since = margin;  // distance from the last originally marked pixel
      for (int k = 0; k < count; ++k) {
        float& d = depth[first + k * stride];
        // 0.5 denotes pixels added in this row or column, which do not count as marked yet.
        since = d == 1.0F ? 0 : std::min(since + 1, margin + 1);
        if (d == 0.0F && since <= margin) d = 0.5F;
      }
    };
    pass(start, step);
    pass(start + (count - 1) * step, -step);
    for (int k = 0; k < count; ++k)
      if (depth[start + k * step] > 0.0F) depth[start + k * step] = 1.0F;
  };
  for (int y = 0; y < h; ++y) widen(y * w, w, 1);
  for (int x = 0; x < w; ++x) widen(x, h, w);
  return depth;
}

}  // namespace palpable
