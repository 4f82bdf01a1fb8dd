/// @file
/// A fine skin that a coarser one carries: each of its points stands on a triangle of the other and
/// keeps its distance from it.
///
///     x = X + sum_k w_k u_k + h sum_k w_k (n_k - N_k)
///
/// with the corners' weights w, displacements u and vertex normals n (N at rest), and h the height
/// of X over the triangle along them. Continuous wherever the coarse skin is, and X where it is at
/// rest; under a rotation by an angle a off by h a^2 / 2 or so.
///
///   V  vertices of the coarse skin
#pragma once

#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/geometry/surface_distance.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

namespace palpable {

/// Where a point of a fine skin stands.
struct CarriedPoint {
  SkinPoint on;      ///< of the coarse skin; its area is not set
  float height = 0;  ///< m, over it

  /// How far it has moved, m.
  /// @param u     (3 x V or more) m, of the coarse skin
  /// @param turn  (3 x V) n - N
  [[nodiscard]] Eigen::Vector3f moved(const Eigen::Matrix3Xf& u,
                                      const Eigen::Matrix3Xf& turn) const {
    return on.at(u) + height * on.at(turn);
  }
};

/// A coarse skin at rest, on which points are stood.
class Carrier {
 public:
  explicit Carrier(const SurfaceMesh& coarse);

  /// A point stands on the nearest triangle that faces its normal's way.
  /// @param place   m, of the fine skin at rest
  /// @param normal  of the fine skin there
  [[nodiscard]] CarriedPoint stand(const Eigen::Vector3d& place,
                                   const Eigen::Vector3d& normal) const;

 private:
  SurfaceDistance surface_;
  Eigen::Matrix3Xd normals_;  // (3 x V)
};

}  // namespace palpable
