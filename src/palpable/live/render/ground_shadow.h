/// @file
/// The soft shadow of a body on the plane on which it stands (body frame Z = 0), as a small image.
#pragma once

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// The body is projected onto the plane along the light; the shadow is darker where the body is
/// nearer to the plane, and blurred. This is no physical light transport: it makes the body appear
/// to stand on the desk instead of floating above it. Things that stand on the plane are shaded by
/// the same image, along the light, up to the height of the part that throws the shadow
/// (real_shadows.h).
class GroundShadow {
 public:
  static constexpr int kSide = 96;  ///< cells per side

  /// Computes the shadow. Allocates nothing once it has seen as many vertices.
  /// @param vertices   (3 x V) m, body frame
  /// @param triangles  (3 x T) vertex indices
  /// @param to_light   unit vector, body frame. No shadow if its Z <= 0 (light from below). The
  ///                   length of slope() is limited to 1.2: lower light is raised to that
  void cast(const Eigen::Matrix3Xf& vertices, const Eigen::Matrix3Xi& triangles,
            const Eigen::Vector3f& to_light);

  /// (kSide x kSide) row-major, row = y; 0 lit .. 1 dark, 0 at the image's border.
  [[nodiscard]] const std::vector<float>& shade() const { return shade_; }
  /// (kSide x kSide) likewise: height (m) of the part that throws the shadow; 0 without shadow.
  [[nodiscard]] const std::vector<float>& height() const { return height_; }
  /// The displacement of a point's shadow along x and y per m of the point's height.
  [[nodiscard]] const Eigen::Vector2f& slope() const { return slope_; }
  /// x0, y0, x1, y1 in m: the outer edges of the cells.
  [[nodiscard]] const Eigen::Vector4f& box() const { return box_; }

 private:
  void blur();
  std::vector<float> shade_ = std::vector<float>(kSide * kSide);
  std::vector<float> height_ = std::vector<float>(kSide * kSide);
  Eigen::Vector2f slope_ = Eigen::Vector2f::Zero();
  std::vector<float> scratch_ = std::vector<float>(kSide * kSide);
  // (3 x V) x, y of each vertex projected onto the plane along the light, and its darkness, which
  // is 1 at the plane.
  Eigen::Matrix3Xf fallen_;
  Eigen::Vector4f box_ = Eigen::Vector4f::Zero();
};

}  // namespace palpable
