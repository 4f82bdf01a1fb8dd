/// @file
/// Where shadows can fall, as seen from the sun. Desk frame (script/desk_body.h), m.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/desk/film/painted_mesh.h"
#include "palpable/desk/film/pixel_box.h"

#include <Eigen/Core>

#include <algorithm>

namespace palpable {

/// The rectangle of a shadow map in which something lies.
class LightBox {
 public:
  /// @param light  desk frame to 0..1 across the map, without perspective, the same scale in both
  ///               directions
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
  /// Whether the two overlap when both are widened by the soft edges of shadows.
  [[nodiscard]] bool meets(const LightBox& other) const {
    return (low_.array() < other.high_.array() + kSpread).all() &&
           (other.low_.array() < high_.array() + kSpread).all();
  }
  /// In texels of a map of this size, with the soft edges.
  [[nodiscard]] Box texels(int size) const {
    const auto clamped = [size](double value) {
      return static_cast<int>(std::clamp(value * size, 0.0, static_cast<double>(size)));
    };
    const int x0 = clamped(low_.x() - kSpread), y0 = clamped(low_.y() - kSpread);
    return {x0, y0, clamped(high_.x() + kSpread) + 1 - x0, clamped(high_.y() + kSpread) + 1 - y0};
  }

 private:
  static constexpr double kSpread = 0.006;  // of the map: soft edges, six texels of the coarser map
  Eigen::Matrix4d light_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(1e6), high_ = Eigen::Vector2d::Constant(-1e6);
};

/// The extent of something that stands still and casts a shadow.
struct Caster {
  LightBox box;
  double top = -1e6;  // m above the desk

  Caster(const PaintedMesh& mesh, const Eigen::Matrix4d& light) : box(light) {
    for (const PaintedVertex& v : mesh.vertices) {
      box.include(v.position.cast<double>(), 0.0);
      top = std::max(top, static_cast<double>(v.position.z()));
    }
  }
  /// false: its shadow cannot fall on the capsule. Light comes from above, so only what is higher
  /// can shade it.
  [[nodiscard]] bool may_shade(const Capsule& capsule, const Eigen::Matrix4d& light) const {
    if (top < std::min(capsule.a.z() - capsule.ra, capsule.b.z() - capsule.rb)) return false;
    LightBox own(light);
    own.include(capsule);
    return box.meets(own);
  }
};

}  // namespace palpable
