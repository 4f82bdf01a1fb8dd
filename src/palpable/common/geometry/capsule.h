/// @file
/// Capsules. Synthetic scenes are built of them (hands, pencils, cups), and the true gaps and
/// distances of a scene are computed from them.
///
/// Metres; the frame is the caller's.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <span>
#include <vector>

namespace palpable {

/// The union of all balls whose centre lies between a and b and whose radius changes linearly from
/// ra to rb: the convex hull of the two spheres, a cone with rounded ends. If one sphere contains
/// the other, it is the larger sphere.
struct Capsule {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double ra = 0;  ///< >= 0
  double rb = 0;  ///< >= 0
};

/// The capsules in another frame.
[[nodiscard]] Capsule transformed(Capsule capsule, const Rigid3& target_from_source);
[[nodiscard]] std::vector<Capsule> transformed(std::vector<Capsule> capsules,
                                               const Rigid3& target_from_source);

/// A capsule on its way: end a goes straight, and the axis turns on the shortest way. It does not
/// spin about its axis.
/// @param t  0: from, 1: to
[[nodiscard]] Capsule interpolated(const Capsule& from, const Capsule& to, double t);

/// A box that contains the capsule; not the smallest one if its radii differ.
[[nodiscard]] Eigen::AlignedBox3d box_of(const Capsule& capsule);

/// The distance field of one capsule whose radii are > 0. The constructor precomputes what all
/// points have in common.
///
/// In the half plane through the axis a point has the coordinates (axial, radial), measured from a.
/// There the cone is a line that touches the circles round a and b:
///
///     its normal     (sine, cosine), with sine = (ra - rb) / length
///     along the line along = cosine * axial - sine * radial: 0 where the line touches the circle
///                    round a, along_end_ where it touches that round b
///
/// A point with along <= 0 is nearest to the sphere at a, one with along >= along_end_ to that at
/// b, any other to the cone.
class CapsuleField {
 public:
  explicit CapsuleField(const Capsule& capsule);

  [[nodiscard]] const Capsule& capsule() const { return capsule_; }
  /// Distance of x to the capsule's surface, negative inside. Exact, in closed form.
  [[nodiscard]] double distance(const Eigen::Vector3d& x) const;
  /// Gradient of the distance at x: a unit vector that points outwards. On the axis, where the
  /// field has a crease, one of the possible directions.
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& x) const;
  /// Second derivative of the distance at x, 1/m: symmetric, positive semidefinite; 0 on the axis.
  [[nodiscard]] Eigen::Matrix3d curvature(const Eigen::Vector3d& x) const;

 private:
  /// A point in the half plane through the axis, m: its distances along the axis and from it, and
  /// its coordinate along the straight flank, which is inclined if the radii differ. The flank
  /// reaches from along = 0 to along_end_.
  struct Profile {
    double axial, radial, along;
  };
  [[nodiscard]] Profile profile_of(const Eigen::Vector3d& x) const;

  Capsule capsule_;
  Eigen::Vector3d axis_ = Eigen::Vector3d::Zero();
  double sine_ = 0, cosine_ = 1, along_end_ = 0;
  bool is_sphere_ = false;
};

/// CapsuleField(capsule).distance(x).
[[nodiscard]] double signed_distance(const Capsule& capsule, const Eigen::Vector3d& x);

/// Signed distance to the union of the capsules, as the smallest of theirs. Exact outside; inside
/// the true depth may be larger. Infinite without capsules.
[[nodiscard]] double signed_distance(std::span<const Capsule> capsules, const Eigen::Vector3d& x);

/// The t at which the ray origin + t * direction (unit) meets the union, by sphere tracing: to
/// within 1e-6 m. Infinite when it meets nothing before t = reach.
[[nodiscard]] double ray_distance(std::span<const Capsule> capsules, const Eigen::Vector3d& origin,
                                  const Eigen::Vector3d& direction, double reach);

}  // namespace palpable
