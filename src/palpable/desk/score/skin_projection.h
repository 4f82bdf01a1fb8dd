/// @file
/// Transfers fields from the vertices of one skin to those of another skin of the same body.
///
///   V  vertices of the skin on which a field is given     N  vertices of the other skin
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

namespace palpable {

/// A vertex of the target skin gets the value at the nearest point of the source skin, both at
/// rest; the field is interpolated linearly between the three corners of the triangle there. If the
/// skins are the same, the values are unchanged.
class SkinProjection {
 public:
  /// @param from  the source skin at rest, with at least one triangle
  /// @param to    (3 x N) m, vertices of the target skin at rest, in the same frame
  /// @throws ContractViolation for a skin without triangles
  SkinProjection(const SurfaceMesh& from, const Eigen::Matrix3Xd& to);

  /// @param field  (3 x V), such as a displacement  @return (3 x N)
  /// @throws ContractViolation when it has another number of columns than V
  [[nodiscard]] Eigen::Matrix3Xd vectors(const Eigen::Matrix3Xd& field) const;
  /// @param field  (V), such as the von Mises stress  @return (N)
  /// @throws ContractViolation when it has another length than V
  [[nodiscard]] Eigen::VectorXd numbers(const Eigen::VectorXd& field) const;

 private:
  Eigen::Index from_count_;
  Eigen::Matrix3Xi corners_;  // (3 x N) triangle of `from` nearest to each vertex of `to`
  Eigen::Matrix3Xd weights_;  // (3 x N) barycentric weights; each column adds up to 1
};

}  // namespace palpable
