/// @file
/// The error of a drawn deformation, its stress and its contact force with respect to the true
/// ones, and how much farther a drawn body is deformed than the obstacle requires.
///
///   N  vertices of the true skin     V  vertices of another skin on which a field is given
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

struct DisplacementError {
  double relative = 0;  ///< L2 norm over the skin, relative to that of the truth
  double worst = 0;     ///< m, largest error of a vertex
};

///     relative = sqrt( sum a |found - truth|^2 / sum a |truth|^2 ),  a: area of the vertex at rest
///
/// A body that is drawn at rest has a relative error of 1. If the true displacement is 0
/// everywhere, the relative error is 0 when the found one is 0, too, and otherwise infinite.
/// @param truth, found  (3 x N) m, displacement from rest
/// @param areas         (N) m^2, vertex_areas() of the skin at rest
/// @throws ContractViolation when the sizes differ or are 0
[[nodiscard]] DisplacementError displacement_error(const Eigen::Matrix3Xd& truth,
                                                   const Eigen::Matrix3Xd& found,
                                                   const Eigen::VectorXd& areas);

/// The largest error of a vertex relative to the largest true stress: max |found - truth| / max
/// truth. If the true stress is 0 everywhere, the error is 0 when the found one is 0, too, and
/// otherwise infinite.
/// @param truth, found  (N) Pa, von Mises stress at the vertices of one skin
/// @throws ContractViolation when they differ in length or are empty
[[nodiscard]] double von_mises_error(const Eigen::VectorXd& truth, const Eigen::VectorXd& found);

/// |sum of the felt forces - truth| / |truth|, the error of the resultant including its direction.
/// It is 1 if no touch was felt. If the true force is 0, it is 0 when nothing was felt and
/// otherwise infinite.
/// @param truth  N, total contact force on the body, body frame
/// @param felt   N, the force of each felt touch, body frame; empty: nothing was felt
[[nodiscard]] double force_error(const Eigen::Vector3d& truth,
                                 std::span<const Eigen::Vector3d> felt);

/// m, radius of a touched place around its point.
inline constexpr double kTouchedPlace = 0.010;

/// Where a true skin is touched: at one place, or at several, as by finger and thumb. The returned
/// points of the skin at rest cover its touched part: each touched sample (DeepestSample, one per
/// triangle and capsule, at most 0.5 mm from it) lies within kTouchedPlace of one of them. They are
/// chosen greedily among the samples, the one with the largest displacement first. Empty if nothing
/// touches.
/// @param rest      m, the true skin at rest
/// @param deformed  the same skin under load: same vertices, same triangles
/// @param hand      m, in the frame of the skin
/// @throws ContractViolation when the skins differ in vertices or triangles
[[nodiscard]] std::vector<Eigen::Vector3d> touched_places(const SurfaceMesh& rest,
                                                          const SurfaceMesh& deformed,
                                                          std::span<const Capsule> hand);

/// Excess of the drawn displacement over the true one at the touched places, m:
///
///     max over the places p, max over the vertices v of p, of (found_v - truth_v) . d_p,
///     at least 0
///
/// The vertices of a place are those within kTouchedPlace of a touched point at
/// rest, at least the nearest one. d_p is the mean direction of their true displacements; each
/// place has its own because a finger and a thumb push in different directions. The penetration
/// does not show a body that deforms too much, since it then stays clear of the hand; this figure
/// does.
/// @param rest          (3 x N) m, vertices of the true skin at rest
/// @param truth, found  (3 x N) m, displacements of these vertices
/// @param touched       m, on the skin at rest, one point per place
/// @throws ContractViolation when the sizes differ, or nothing is touched
[[nodiscard]] double overpress(const Eigen::Matrix3Xd& rest, const Eigen::Matrix3Xd& truth,
                               const Eigen::Matrix3Xd& found,
                               std::span<const Eigen::Vector3d> touched);

/// Transfers fields from the vertices of one skin to those of another skin of the same body. A
/// vertex of the target skin gets the value at the nearest point of the source skin, both at
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
