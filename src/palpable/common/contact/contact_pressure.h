/// @file
/// The contact pressure on a skin: the forces at pressed points, spread over the vertices around
/// them.
///
/// A force at a point stands for the skin up to the next pressed point, at a distance s; vertices
/// are h apart. The force is shared among the vertices within r = 1.5 max(s, h) that face it,
///
///     f_v = sum_i |f_i - t_i| w_iv / sum_v w_iv,    w_iv = A_v (1 - |x_v - x_i|^2 / r^2)
///     p_v = f_v / A_v
///
/// with A_v a third of the area of the triangles around v, all in the present shape, and t_i the
/// friction in f_i. So sum_v p_v A_v is the sum of all normal forces, and p is what a pressure film
/// between skin and obstacle would measure; details finer than the mesh or the points are not
/// resolved.
///
///   V  vertices of the skin
#pragma once

#include "palpable/common/contact/touch_patches.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// Keeps its memory: spread() allocates nothing once `pressure` has had its room.
class ContactPressure {
 public:
  /// @param skin  at rest, with triangles
  explicit ContactPressure(const SurfaceMesh& skin);

  /// @param pressed   with points in this shape; after TouchPatches::find()
  /// @param vertices  (3 x V) m, present positions, in the frame of the points
  /// @param normals   (3 x V) unit, outwards
  /// @param pressure  (V) Pa, overwritten: above 0 where something presses, else 0
  void spread(const TouchPatches& pressed, const Eigen::Matrix3Xf& vertices,
              const Eigen::Matrix3Xf& normals, std::vector<float>& pressure);

 private:
  void find_near(const TouchPatches& pressed, const Eigen::Matrix3Xf& vertices);
  [[nodiscard]] float reach(float spacing) const;

  Eigen::Matrix3Xi triangles_;
  float usual_edge_;            // m, h
  std::vector<int> near_;       // vertices that a pressed point may reach
  std::vector<char> is_near_;   // (V)
  std::vector<float> areas_;    // (V) m^2, of the near vertices
  std::vector<float> weights_;  // of the near vertices, for one point
};

}  // namespace palpable
