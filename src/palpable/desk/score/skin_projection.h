/// @file
/// What one system says at the vertices of its skin, at the vertices of another skin of the same
/// body.
///
///   N  vertices of the skin that is compared with     V  those of the one that says something
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

namespace palpable {

/// Each vertex of the one skin looks at the point of the other that is nearest to it while the body
/// is at rest; there the other's field is linear between the three corners of a triangle. Where
/// both skins are the same, the values stay as they are.
class SkinProjection {
 public:
  /// @param from  the skin at rest whose fields are given, with at least one triangle
  /// @param to    (3 x N) the vertices at rest at which they are wanted; the same frame
  /// @throws ContractViolation for a skin without triangles
  SkinProjection(const SurfaceMesh& from, const Eigen::Matrix3Xd& to);

  /// @param field  (3 x V), as the displacement  @return (3 x N)
  /// @throws ContractViolation when it is not one value per vertex, as does the next
  [[nodiscard]] Eigen::Matrix3Xd vectors(const Eigen::Matrix3Xd& field) const;
  /// @param field  (V), as the von Mises stress  @return (N)
  [[nodiscard]] Eigen::VectorXd numbers(const Eigen::VectorXd& field) const;

 private:
  Eigen::Index from_count_;
  Eigen::Matrix3Xi corners_;  // (3 x N) vertices of `from` next to each vertex of `to`
  Eigen::Matrix3Xd weights_;  // (3 x N) of these; each column adds up to 1
};

}  // namespace palpable
