#include "palpable/live/depth/depth_registration.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/depth/depth_gaps.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace palpable {
namespace {

constexpr float kLeastInverse = 1e-4F;  // 1/m; excludes points behind the camera or beyond 10 km
// Width by which a triangle is enlarged, as a share of its height. Without it, rounding could leave
// pixels on a common side of two triangles to neither of them.
constexpr float kOverlap = 1e-3F;

Eigen::Matrix3d matrix_of(const PinholeCamera& camera) {
  Eigen::Matrix3d K;
  K << camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1;
  return K;
}

struct Range {
  float low, high;
};
Range range_of(float a, float b, float c) {
  return {std::min(std::min(a, b), c), std::max(std::max(a, b), c)};
}

// The pixels whose centres may lie within a range; empty if last < first.
struct Pixels {
  int first = 0, last = -1;
};
Pixels pixels_between(const Range& range, int size) {
  const auto end = static_cast<float>(size);
  if (!(range.high >= 0 && range.low < end)) return {};
  // Casts of non-negative numbers, because std::floor is a function call with plain SSE2.
  return {range.low > 0 ? static_cast<int>(range.low + 1 - kOverlap) : 0,
          static_cast<int>(std::min(range.high + kOverlap, end - 1))};
}

}  // namespace

DepthRegistration::DepthRegistration(const PinholeCamera& depth_camera, const ColorSensor& color)
    : width_(depth_camera.width),
      height_(depth_camera.height),
      color_width_(color.camera.width),
      color_height_(color.camera.height) {
  PALPABLE_EXPECT(depth_camera.fx_px > 0 && depth_camera.fy_px > 0 && color.camera.fx_px > 0 &&
                      color.camera.fy_px > 0,
                  "focal lengths are positive");
  const Eigen::Matrix3d K = matrix_of(color.camera);
  M_ = (K * color.color_from_depth.linear() * matrix_of(depth_camera).inverse()).cast<float>();
  q_ = (K * color.color_from_depth.translation()).cast<float>();
}

void DepthRegistration::project_row(const DepthImage& depth, int y,
                                    std::vector<Corner>& row) const {
  const float* Z = bridged_.row(y);
  const Eigen::Vector3f start = M_.col(1) * static_cast<float>(y) + M_.col(2);
  for (int x = 0; x < width_; ++x) {
    Corner& corner = row[x];
    const Eigen::Vector3f p = Z[x] * (start + M_.col(0) * static_cast<float>(x)) + q_;
    const float w = 1 / p.z();
    const bool seen = w > kLeastInverse && Z[x] > 0;  // false for NaN
    corner = {Z[x], p.x() * w, p.y() * w, seen ? w : 0.0F, depth(x, y) > 0};
  }
}

// The corner a has the right angle of the depth image's pixels, so that b is the nearest corner if
// its share is above a half, and a if no other is. A point halfway is the unmeasured one's,
// whatever the rounding.
bool DepthRegistration::is_unmeasured(const Corner& a, const Corner& b, const Corner& c, float in_b,
                                      float in_c, float area) {
  const float low = (0.5F - kOverlap) * area, high = (0.5F + kOverlap) * area;
  return (!a.measured && in_b <= high && in_c <= high) || (!b.measured && in_b >= low) ||
         (!c.measured && in_c >= low);
}

void DepthRegistration::draw(const Corner& a, const Corner& b, const Corner& c, DepthImage& into) {
  if (!(a.w > 0 && b.w > 0 && c.w > 0)) return;
  const auto [least, most] = range_of(a.Z, b.Z, c.Z);
  if (most > kSurfaceJump * least) return;
  const float bu = b.u - a.u, bv = b.v - a.v;
  const float cu = c.u - a.u, cv = c.v - a.v;
  const float area = bu * cv - cu * bv;
  if (!(area > 0)) return;  // seen from behind
  const bool all_measured = a.measured && b.measured && c.measured;
  if (!(a.measured || b.measured || c.measured)) return;
  const Pixels us = pixels_between(range_of(a.u, b.u, c.u), into.width());
  const Pixels vs = pixels_between(range_of(a.v, b.v, c.v), into.height());
  for (int v = vs.first; v <= vs.last; ++v) {
    float* row = into.row(v);
    for (int u = us.first; u <= us.last; ++u) {
      const float du = static_cast<float>(u) - a.u, dv = static_cast<float>(v) - a.v;
      const float in_b = du * cv - cu * dv;  // barycentric coordinates of b and c, times the area
      const float in_c = bu * dv - du * bv;
      const float over = kOverlap * area;
      if (in_b < -over || in_c < -over || in_b + in_c > area + over) continue;
      if (!all_measured && is_unmeasured(a, b, c, in_b, in_c, area)) continue;
      const float Z = area / (area * a.w + in_b * (b.w - a.w) + in_c * (c.w - a.w));
      if (!(row[u] <= Z)) row[u] = Z;  // also if row[u] is NaN: nothing was drawn yet
    }
  }
}

void DepthRegistration::to_color(const DepthImage& depth, DepthImage& in_color) {
  PALPABLE_EXPECT(depth.width() == width_ && depth.height() == height_,
                  "the depth image is of the depth camera's size");
  in_color.resize(color_width_, color_height_);
  std::fill(in_color.begin(), in_color.end(), std::numeric_limits<float>::quiet_NaN());
  if (width_ < 2 || height_ < 2) return;
  bridge_gaps(depth, bridged_);
  above_.resize(width_);
  below_.resize(width_);
  project_row(depth, 0, below_);
  for (int y = 1; y < height_; ++y) {
    above_.swap(below_);
    project_row(depth, y, below_);
    for (std::size_t x = 1; x < above_.size(); ++x) {
      draw(above_[x - 1], above_[x], below_[x - 1], in_color);
      draw(below_[x], below_[x - 1], above_[x], in_color);
    }
  }
}

}  // namespace palpable
