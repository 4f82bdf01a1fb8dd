/// @file
/// Maps pixels with depths to points in a frame other than the camera's.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

namespace palpable {

/// Uses that the point of pixel (x, y) at depth Z is origin + Z (first + x across + y down).
class RayToRegion {
 public:
  RayToRegion(const PinholeCamera& camera, const Rigid3& region_from_camera)
      : origin_(region_from_camera.translation().cast<float>()) {
    const Eigen::Matrix3f R = region_from_camera.linear().cast<float>();
    across_ = R.col(0) / static_cast<float>(camera.fx_px);
    down_ = R.col(1) / static_cast<float>(camera.fy_px);
    first_ = R.col(2) - static_cast<float>(camera.cx_px) * across_ -
             static_cast<float>(camera.cy_px) * down_;
  }
  /// @param z  m, depth of the pixel
  [[nodiscard]] Eigen::Vector3f point(int x, int y, float z) const {
    return origin_ + z * direction(x, y);
  }
  /// The direction of the pixel's ray, scaled to 1 m of Z.
  [[nodiscard]] Eigen::Vector3f direction(int x, int y) const {
    return first_ + static_cast<float>(x) * across_ + static_cast<float>(y) * down_;
  }

 private:
  Eigen::Vector3f origin_, across_, down_, first_;
};

}  // namespace palpable
