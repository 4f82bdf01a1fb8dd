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

/// A closed triangle surface; shared, because an obstacle is copied for each place that it takes.
struct PlacedSurface {
  std::shared_ptr<const SurfaceDistance> shape;  ///< in its own frame
  Rigid3 body_from_shape = Rigid3::Identity();
};

/// Everything rigid that may touch a body, at one moment. Parts may overlap: each keeps the body
/// out by itself, so that together they are their union.
struct Obstacle {
  std::vector<Capsule> capsules = {};  ///< radii > 0
  std::vector<HalfSpace> half_spaces = {};
  std::vector<PlacedSurface> surfaces = {};

  [[nodiscard]] int part_count() const {
    return static_cast<int>(capsules.size() + half_spaces.size() + surfaces.size());
  }
};

/// A capsule with both ends in one place.
[[nodiscard]] Capsule ball(const Eigen::Vector3d& centre, double radius);

/// The same obstacle, moved.
[[nodiscard]] Obstacle moved(Obstacle obstacle, const Rigid3& target_from_source);

/// Smallest radius of curvature of all capsules, m; infinite without any.
[[nodiscard]] double smallest_radius(const Obstacle& obstacle);

/// Where a point that is fixed to a part of an obstacle goes while the obstacle moves from one
/// place to another. A capsule does not spin about its own axis.
/// @pre both have the same parts
[[nodiscard]] Eigen::Vector3d carried(const Obstacle& from, const Obstacle& to, int part,
                                      const Eigen::Vector3d& x);

/// The way of an obstacle: where it is at time t. Continuous where it presses; parts that do not
/// may come and go.
using ObstacleMotion = std::function<Obstacle(double t)>;

/// Distance of a point to one part, and its derivatives there.
struct Gap {
  double distance = 0;                                ///< m, negative inside
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< gradient: a unit vector, out of the part
  /// Second derivative, 1/m. Zero for a surface's faces, and said to be zero for its edges and
  /// corners, where it is a peak without width.
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
};

/// The parts of an obstacle, prepared to be asked for many points.
class ObstacleGaps {
 public:
  explicit ObstacleGaps(Obstacle obstacle);

  [[nodiscard]] const Obstacle& obstacle() const { return obstacle_; }
  [[nodiscard]] int part_count() const { return obstacle_.part_count(); }
  [[nodiscard]] double distance(int part, const Eigen::Vector3d& x) const;
  /// To the nearest part; infinite without any.
  [[nodiscard]] double distance(const Eigen::Vector3d& x) const;
  [[nodiscard]] Gap gap(int part, const Eigen::Vector3d& x) const;
  /// Points in the middle of a part, or on a surface: a body that the part presses from outside
  /// holds none of them, but for what enters between its contact points. Of a half space none.
  [[nodiscard]] std::vector<Eigen::Vector3d> core(int part) const;
  /// Whether the part may reach into the box.
  [[nodiscard]] bool may_reach(int part, const Eigen::AlignedBox3d& box) const;

 private:
  Obstacle obstacle_;
  std::vector<CapsuleField> capsules_;
};

}  // namespace palpable
