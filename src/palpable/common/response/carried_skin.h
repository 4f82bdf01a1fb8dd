/// @file
/// A fine skin that a coarser one carries: each point of the fine skin is attached to a triangle of
/// the coarse skin and keeps its height over that triangle.
///
///     x = X + sum_k w_k u_k + h sum_k w_k (n_k - N_k)
///
/// with X the point at rest, h its height along the interpolated normal, and of the triangle's
/// corners k the weights w, displacements u and vertex normals n (N at rest). The map is continuous
/// wherever the coarse skin is, and x = X while the coarse skin is at rest. A rotation R of the
/// coarse skin is reproduced except for (R - 1) d, with d the part of X's offset from the triangle
/// that differs from h sum_k w_k N_k.
///
///   V  vertices of the coarse skin
#pragma once

#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/geometry/surface_distance.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

namespace palpable {

/// The triangle of the coarse skin that a point of the fine skin is attached to.
struct CarriedPoint {
  SkinPoint on;      ///< position on the coarse skin; its area is not set
  float height = 0;  ///< m, over that position

  /// The point's displacement, m.
  /// @param u     (3 x V or more columns) m, displacement of the coarse skin
  /// @param turn  (3 x V) n - N, by how much the coarse skin's vertex normals have turned
  [[nodiscard]] Eigen::Vector3f moved(const Eigen::Matrix3Xf& u,
                                      const Eigen::Matrix3Xf& turn) const {
    return on.at(u) + height * on.at(turn);
  }
};

/// A coarse skin at rest, to which points are attached.
class Carrier {
 public:
  explicit Carrier(const SurfaceMesh& coarse);

  /// Attaches a point to the nearest triangle whose normal agrees with the point's normal.
  /// @param place   m, position on the fine skin at rest
  /// @param normal  of the fine skin at that position
  [[nodiscard]] CarriedPoint stand(const Eigen::Vector3d& place,
                                   const Eigen::Vector3d& normal) const;

 private:
  SurfaceDistance surface_;
  Eigen::Matrix3Xd normals_;  // (3 x V)
};

}  // namespace palpable
