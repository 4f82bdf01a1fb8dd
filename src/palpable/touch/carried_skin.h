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
///   V  vertices of the coarse skin     P  points that it carries
#pragma once

#include "palpable/geometry/skin_points.h"
#include "palpable/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// Where a point of a fine skin stands.
struct CarriedPoint {
  SkinPoint on;      ///< of the coarse skin; its area is that of the fine point
  float height = 0;  ///< m, over it
};

/// Carries any points.
class CarriedSkin {
 public:
  /// Nothing is carried.
  CarriedSkin() = default;
  /// @param coarse  at rest
  /// @param places, normals  (3 x P) m, of the fine skin at rest: a point stands on the nearest
  ///                         triangle that faces its normal's way
  CarriedSkin(const SurfaceMesh& coarse, const Eigen::Matrix3Xd& places,
              const Eigen::Matrix3Xd& normals);

  [[nodiscard]] std::span<const CarriedPoint> points() const { return points_; }

  /// How far a point has moved, m.
  /// @param u     (3 x V or more) m, of the coarse skin
  /// @param turn  (3 x V) n - N
  [[nodiscard]] Eigen::Vector3f moved(std::size_t point, const Eigen::Matrix3Xf& u,
                                      const Eigen::Matrix3Xf& turn) const {
    const CarriedPoint& p = points_[point];
    return p.on.at(u) + p.height * p.on.at(turn);
  }

 private:
  std::vector<CarriedPoint> points_;
};

}  // namespace palpable
