#include "palpable/common/geometry/pixel_box.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>

namespace palpable {

PixelBox box_in_image(const Eigen::AlignedBox3d& space, const Rigid3& camera_from_space,
                      const PinholeCamera& camera) {
  PALPABLE_EXPECT(!space.isEmpty(), "a box of space that is not empty");
  constexpr double kNearest = 1e-3;  // m
  Eigen::AlignedBox2d seen;
  int behind = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d x =
        camera_from_space * space.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
    if (x.z() < kNearest) {
      ++behind;
      continue;
    }
    seen.extend(Eigen::Vector2d(camera.cx_px + camera.fx_px * x.x() / x.z(),
                                camera.cy_px + camera.fy_px * x.y() / x.z()));
  }
  if (behind == 8) return {};
  if (behind > 0) return {0, 0, camera.width, camera.height};
  const auto pixel = [](double p, int count) {
    return static_cast<int>(std::clamp(std::floor(p), 0.0, static_cast<double>(count)));
  };
  const int left = pixel(seen.min().x(), camera.width), top = pixel(seen.min().y(), camera.height);
  const int right = pixel(seen.max().x() + 1, camera.width);
  const int bottom = pixel(seen.max().y() + 1, camera.height);
  return PixelBox::between(left, top, right, bottom);
}

PixelBox grown(const PixelBox& box, int margin, const PinholeCamera& camera) {
  const int left = std::max(box.x - margin, 0), top = std::max(box.y - margin, 0);
  const int right = std::min(box.right() + margin, camera.width);
  const int bottom = std::min(box.bottom() + margin, camera.height);
  return {left, top, std::max(right - left, 0), std::max(bottom - top, 0)};
}

}  // namespace palpable
