/// @file
/// Shadows between bodies and real things with known depth: that of a body on the desk and on
/// things that stand there, and that of a hand on a body. They are computed on the CPU: a software
/// renderer would run all of a shader for each pixel and vertex, while the code here rejects most
/// of them by one comparison.
///
/// Pixels are the picture's, texels those of the real depth. Camera frame, m.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/render/fill_unknown.h"
#include "palpable/live/render/ground_shadow.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// The real depth around bodies. Views.
struct RealSurface {
  std::span<const float> depth;  ///< (box.height x box.width) row-major, Z in m; 0 unknown
  PixelBox box;                  ///< texels; empty: nothing is known
  Eigen::Vector2d texels_per_pixel = Eigen::Vector2d::Zero();
  PinholeCamera camera;  ///< of the picture

  /// Z at a position in the picture, px from its top left corner; 0 unknown.
  [[nodiscard]] float at(double x_px, double y_px) const {
    const int x = static_cast<int>(x_px * texels_per_pixel.x()) - box.x;
    const int y = static_cast<int>(y_px * texels_per_pixel.y()) - box.y;
    if (x < 0 || y < 0 || x >= box.width || y >= box.height) return 0;
    return depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(box.width) +
                 static_cast<std::size_t>(x)];
  }
};

/// The shade of bodies on real things: one value for each 2 x 2 pixels of a rectangle.
class ShadeOnReal {
 public:
  /// Begins a picture, without any shade. @param box  of the picture, px
  void clear(const PixelBox& box);

  /// Adds the shade of a body on real surfaces: on those within 8 mm (plus the noise) of its plane
  /// Z = 0, on pixels without depth, which are taken to lie in that plane, and on things that stand
  /// on it, up to the height of the part that throws the shadow. Surfaces below the plane are lit.
  /// @param strength  0 .. 1: how dark a full shadow is
  void add(const GroundShadow& shadow, const Rigid3& camera_from_body, double strength,
           const RealSurface& real);

  /// The part of the picture (px) that has any shade.
  [[nodiscard]] const PixelBox& shaded() const { return shaded_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// (height x width) row-major: the share of the light that is left.
  [[nodiscard]] const std::vector<float>& left() const { return left_; }

 private:
  PixelBox box_, shaded_;
  int width_ = 0, height_ = 0;
  std::vector<float> left_;
};

/// The shade of real things on a body. A ray from each vertex towards the lamp is followed; where
/// it passes behind a real surface by less than 35 mm, the thickness of a hand, that surface shades
/// the vertex. Only surfaces that the camera sees throw shadows.
class ShadeOnBody {
 public:
  /// Sets the real surface. Allocates nothing once it has seen a box of this size.
  void see(const RealSurface& real);

  /// @param vertices  (3 x V) m, body frame
  /// @param normals   (3 x V) unit
  /// @param to_light  camera frame, unit
  /// @param shaded    (V) overwritten: the share of the lamp's light that does not reach the vertex
  void find(const Eigen::Matrix3Xf& vertices, const Eigen::Matrix3Xf& normals,
            const Rigid3& camera_from_body, const Eigen::Vector3f& to_light,
            std::span<float> shaded) const;

 private:
  [[nodiscard]] bool free_up_to(float z, const Eigen::Vector2f& a, const Eigen::Vector2f& b) const;

  RealSurface real_;
  int blocks_x_ = 0, blocks_y_ = 0;
  std::vector<float> nearest_;  // Z of the nearest texel of each block; infinite without any
};

}  // namespace palpable
