/// @file
/// The soft shadow of a body on the plane that it stands on (body frame Z = 0), as a small image.
#pragma once

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// Not a solution of any light transport: the part of the plane behind the body as seen from the
/// light, the darker the nearer the body is to the plane, blurred. Its purpose is that a body
/// stands on the desk and does not float.
class GroundShadow {
 public:
  static constexpr int kSide = 64;  ///< cells per side

  /// @param to_light  unit vector in the body frame; its Z > 0 (a light from below casts none)
  void cast(const Eigen::Matrix3Xf& vertices, const Eigen::Matrix3Xi& triangles,
            const Eigen::Vector3f& to_light);

  /// (kSide x kSide) row-major, row = y; 0 lit .. 1 dark, 0 at the rim.
  [[nodiscard]] const std::vector<float>& shade() const { return shade_; }
  /// x0, y0, x1, y1 in m: the outer edges of the cells.
  [[nodiscard]] const Eigen::Vector4f& box() const { return box_; }

 private:
  void blur();
  std::vector<float> shade_ = std::vector<float>(kSide * kSide);
  std::vector<float> scratch_ = std::vector<float>(kSide * kSide);
  Eigen::Matrix3Xf fallen_;  // x, y where the light takes a vertex to the plane; closeness to it
  Eigen::Vector4f box_ = Eigen::Vector4f::Zero();
};

}  // namespace palpable
