/// @file
/// Distances to capsules, and their triangles: what the synthetic hand is made of, and what its
/// truth is measured against. Here both radii are > 0.
///
/// Metres; the frame is the caller's.
#pragma once

#include "palpable/geometry/capsule.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// A capsule's distance field, for many points.
///
/// The line that touches both circles of its profile has the normal (cosine, sine) over (radial,
/// axial), with sine = (ra - rb) / length; `along` runs on it from the tangent point of a (0) to
/// that of b.
class CapsuleField {
 public:
  explicit CapsuleField(const Capsule& capsule);

  /// Distance of x to the capsule's surface, negative inside; exact (closed form).
  [[nodiscard]] double distance(const Eigen::Vector3d& x) const;
  /// Unit outward normal of the field at x; any unit vector on the axis, where it has a crease.
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& x) const;

 private:
  struct Profile {
    double axial, radial, along;
  };
  [[nodiscard]] Profile profile_of(const Eigen::Vector3d& x) const;

  Capsule capsule_;
  Eigen::Vector3d axis_ = Eigen::Vector3d::Zero();
  double sine_ = 0, cosine_ = 1, along_end_ = 0;
  bool is_sphere_ = false;
};

/// CapsuleField's, for one point.
[[nodiscard]] double signed_distance(const Capsule& capsule, const Eigen::Vector3d& x);

/// Distance to the union: the smallest of the capsules'; exact outside, a bound inside. Infinite
/// for no capsules.
[[nodiscard]] double signed_distance(std::span<const Capsule> capsules, const Eigen::Vector3d& x);

/// CapsuleField's, for one point.
[[nodiscard]] Eigen::Vector3d distance_normal(const Capsule& capsule, const Eigen::Vector3d& x);

/// Distance along the ray origin + t * direction (unit) to the union, by sphere tracing to 1e-6 m;
/// infinite when nothing is met within `reach`.
[[nodiscard]] double ray_distance(std::span<const Capsule> capsules, const Eigen::Vector3d& origin,
                                  const Eigen::Vector3d& direction, double reach);

/// A capsule as triangles. Vertices lie on the surface; between them the triangles run at most
/// `chord_error` inside it, so half that distance is the mean error.
struct CapsuleMesh {
  Eigen::Matrix3Xd vertices;   ///< (3 x N) m
  Eigen::Matrix3Xd normals;    ///< (3 x N) unit, outwards
  Eigen::Matrix2Xd where;      ///< (2 x N) distance along the surface from a (m); angle round it
  Eigen::Matrix3Xi triangles;  ///< (3 x M) counter-clockwise seen from outside
};

/// @param side  direction of angle 0 round the axis; need not be perpendicular to it
[[nodiscard]] CapsuleMesh tessellate(const Capsule& capsule, const Eigen::Vector3d& side,
                                     double chord_error);

}  // namespace palpable
