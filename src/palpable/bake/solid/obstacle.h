/// @file
/// Rigid obstacles that press a body, as values: capsules, half spaces, closed surfaces.
///
/// Metres, in the body frame.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_distance.h"

#include <Eigen/Core>

#include <functional>
#include <memory>
#include <vector>

namespace palpable {

/// All points x with normal . (x - point) < 0 are solid.
struct HalfSpace {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, out of the solid
};

/// A closed triangle surface. It is shared, because the obstacle is copied for each of its poses.
struct PlacedSurface {
  std::shared_ptr<const SurfaceDistance> shape;  ///< in its own frame
  Rigid3 body_from_shape = Rigid3::Identity();
};

/// All rigid things that may touch a body, at one instant. Parts may overlap: the body is kept out
/// of each of them, and so out of their union.
struct Obstacle {
  std::vector<Capsule> capsules = {};  ///< radii > 0
  std::vector<HalfSpace> half_spaces = {};
  std::vector<PlacedSurface> surfaces = {};

  [[nodiscard]] int part_count() const {
    return static_cast<int>(capsules.size() + half_spaces.size() + surfaces.size());
  }
};

/// A capsule whose ends coincide.
[[nodiscard]] Capsule ball(const Eigen::Vector3d& centre, double radius);

/// The same obstacle, moved.
[[nodiscard]] Obstacle moved(Obstacle obstacle, const Rigid3& target_from_source);

/// An obstacle on its way. Surfaces and half spaces turn on the shortest way, capsules as
/// interpolated() of geometry/capsule.h.
/// @param t  0: from, 1: to
/// @pre both have the same parts
[[nodiscard]] Obstacle interpolated(const Obstacle& from, const Obstacle& to, double t);

/// Smallest radius of curvature of all capsules, m; infinite without any.
[[nodiscard]] double smallest_radius(const Obstacle& obstacle);

enum class PartKind { kCapsule, kHalfSpace, kSurface };
/// @param part  number of a part: capsules first, then half spaces, then surfaces
[[nodiscard]] PartKind part_kind(const Obstacle& obstacle, int part);

/// Whether both have as many parts of each kind.
[[nodiscard]] bool has_same_parts(const Obstacle& a, const Obstacle& b);

/// New position of a point x that is fixed to a part of an obstacle, when the obstacle moves from
/// `from` to `to`, where the part has the number `to_part`. A capsule does not spin about its own
/// axis.
/// @pre both parts are of one kind
[[nodiscard]] Eigen::Vector3d carried(const Obstacle& from, int from_part, const Obstacle& to,
                                      int to_part, const Eigen::Vector3d& x);
/// The same, where both have the same parts.
[[nodiscard]] Eigen::Vector3d carried(const Obstacle& from, const Obstacle& to, int part,
                                      const Eigen::Vector3d& x);

/// The motion of an obstacle: its pose at time t. It must be continuous for parts that press the
/// body; other parts may appear and disappear.
using ObstacleMotion = std::function<Obstacle(double t)>;

/// Distance of a point to one part, and its derivatives there.
struct Gap {
  double distance = 0;                                ///< m, negative inside
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< gradient: a unit vector, out of the part
  /// Second derivative, 1/m. Zero on a surface's faces, and set to zero at its edges and corners,
  /// where it is singular.
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
};

/// The parts of an obstacle, prepared for distance queries at many points.
class ObstacleGaps {
 public:
  explicit ObstacleGaps(Obstacle obstacle);

  [[nodiscard]] const Obstacle& obstacle() const { return obstacle_; }
  [[nodiscard]] int part_count() const { return obstacle_.part_count(); }
  [[nodiscard]] double distance(int part, const Eigen::Vector3d& x) const;
  /// Distance to the nearest part; infinite without any.
  [[nodiscard]] double distance(const Eigen::Vector3d& x) const;
  [[nodiscard]] Gap gap(int part, const Eigen::Vector3d& x) const;
  /// Points on the axis of a capsule, or the vertices of a surface; none for a half space. A body
  /// that the part presses from outside contains none of them, except where the part penetrates
  /// between contact points.
  [[nodiscard]] std::vector<Eigen::Vector3d> core(int part) const;
  /// Whether the part may reach into the box.
  [[nodiscard]] bool may_reach(int part, const Eigen::AlignedBox3d& box) const;

 private:
  Obstacle obstacle_;
  std::vector<CapsuleField> capsules_;
};

}  // namespace palpable
