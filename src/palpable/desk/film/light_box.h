/// @file
/// Extents of things in a shadow map, to decide which shadows can fall on which things. Desk frame
/// (script/desk_body.h), m.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/desk/film/painted_mesh.h"

#include <Eigen/Core>

#include <algorithm>

namespace palpable {

/// The bounding rectangle of a thing in a shadow map.
class LightBox {
 public:
  /// @param light  from the desk frame to 0..1 across the map; orthographic, with equal scales
  explicit LightBox(const Eigen::Matrix4d& light) : light_(light) {}
  void include(const Capsule& capsule) {
    include(capsule.a, capsule.ra);
    include(capsule.b, capsule.rb);
  }
  void include(const Eigen::Vector3d& x, double radius) {
    const Eigen::Vector2d at = light_.topLeftCorner<2, 3>() * x + light_.topRightCorner<2, 1>();
    const double reach = radius * light_.block<1, 3>(0, 0).norm();
    low_ = low_.cwiseMin(at - Eigen::Vector2d::Constant(reach));
    high_ = high_.cwiseMax(at + Eigen::Vector2d::Constant(reach));
  }
  /// Whether the two overlap, with a margin for the soft edges of shadows.
  [[nodiscard]] bool meets(const LightBox& other) const {
    return (low_.array() < other.high_.array() + kSpread).all() &&
           (other.low_.array() < high_.array() + kSpread).all();
  }
  /// The rectangle in texels of a map of this size, including the soft edges.
  [[nodiscard]] PixelBox texels(int size) const {
    const auto clamped = [size](double value) {
      return static_cast<int>(std::clamp(value * size, 0.0, static_cast<double>(size)));
    };
    const int x0 = clamped(low_.x() - kSpread), y0 = clamped(low_.y() - kSpread);
    return {x0, y0, clamped(high_.x() + kSpread) + 1 - x0, clamped(high_.y() + kSpread) + 1 - y0};
  }

 private:
  // Ratio to the map's width: soft edges, six texels of the coarser map.
  static constexpr double kSpread = 0.006;
  Eigen::Matrix4d light_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(1e6), high_ = Eigen::Vector2d::Constant(-1e6);
};

/// The extent of a still thing that casts a shadow.
struct Caster {
  LightBox box;
  double top = -1e6;  // m above the desk

  Caster(const PaintedMesh& mesh, const Eigen::Matrix4d& light) : box(light) {
    for (const PaintedVertex& v : mesh.vertices) {
      box.include(v.position.cast<double>(), 0.0);
      top = std::max(top, static_cast<double>(v.position.z()));
    }
  }
  /// Whether its shadow may fall on the capsule. Light comes from above, so only a thing that is
  /// higher than the capsule's lowest point can shade it.
  [[nodiscard]] bool may_shade(const Capsule& capsule, const Eigen::Matrix4d& light) const {
    if (top < std::min(capsule.a.z() - capsule.ra, capsule.b.z() - capsule.rb)) return false;
    LightBox own(light);
    own.include(capsule);
    return box.meets(own);
  }
};

}  // namespace palpable
