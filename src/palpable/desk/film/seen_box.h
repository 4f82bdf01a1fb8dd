/// @file
/// The part of a picture that shows movers.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/pixel_box.h"

#include <Eigen/Core>

#include <algorithm>

namespace palpable {

/// The bounding rectangle, in the picture of an eye, of the parts of capsules beyond the near
/// plane.
class SeenBox {
 public:
  static constexpr double kNearest = 0.02;  ///< m, near plane: nothing nearer is drawn

  explicit SeenBox(const PinholeCamera& view) : view_(view) {}

  /// Adds the convex hull of two spheres; eye frame, m.
  void include(const Eigen::Vector3d& a, double ra, const Eigen::Vector3d& b, double rb) {
    include(a, ra);
    include(b, rb);
    // If the near plane cuts the hull, the cross-section lies between the two spheres of the hull
    // that touch the plane from either side. The picture of the part beyond the plane is the hull
    // of the pictures of the ends beyond it and of this cross-section.
    const Eigen::Vector3d ab = b - a;
    for (const double side : {-1.0, 1.0}) {
      const double slope = ab.z() - side * (rb - ra);
      const double along = (kNearest + side * ra - a.z()) / slope;
      if (along > 0.0 && along < 1.0) include(a + along * ab, ra + along * (rb - ra));
    }
  }
  [[nodiscard]] PixelBox pixels() const {
    const auto clamped = [](double value, int limit) {
      return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
    };
    const int x0 = clamped(view_.fx_px * low_.x() + view_.cx_px - kRounding, view_.width);
    const int y0 = clamped(view_.fy_px * low_.y() + view_.cy_px - kRounding, view_.height);
    return {x0, y0, clamped(view_.fx_px * high_.x() + view_.cx_px + kRounding, view_.width) - x0,
            clamped(view_.fy_px * high_.y() + view_.cy_px + kRounding, view_.height) - y0};
  }

 private:
  static constexpr double kRounding = 2.0;  // px, margin for chords of triangles and rounding
  PinholeCamera view_;
  // Bounds of x/Z and y/Z; low > high as long as nothing is included.
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(1e6), high_ = Eigen::Vector2d::Constant(-1e6);

  void include(const Eigen::Vector3d& x, double radius) {
    const double far = x.z() + radius;
    if (far < kNearest - 1e-9) return;  // a sphere that just touches the plane is included
    const double near = std::max(kNearest, x.z() - radius);
    for (int axis = 0; axis < 2; ++axis) {
      const double low = x[axis] - radius, high = x[axis] + radius;
      low_[axis] = std::min(low_[axis], low / (low > 0.0 ? far : near));
      high_[axis] = std::max(high_[axis], high / (high > 0.0 ? near : far));
    }
  }
};

}  // namespace palpable
