/// @file
/// The points of a body's skin at which obstacles may not enter it.
///
///   N  nodes     C  contact points
///
/// Corners alone would let a pencil's tip, which is smaller than a triangle, pass between them. So
/// points lie on a grid over every triangle of the skin: its corners, points along its edges and
/// inside it, none farther than `spacing` from the next along an edge.
///
/// Between the points an obstacle of radius r enters by spacing^2 / (8 r) at most where the skin is
/// flat, and by the slope times spacing / 2 at a fold; contact.h measures it for each state.
#pragma once

#include "palpable/common/geometry/tet_mesh.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace palpable {

/// A point of the skin: a fixed mean of nodes, whatever they do.
struct ContactPoint {
  std::array<int, 6> nodes{};     ///< of the mesh; the first `count`
  std::array<double, 6> shape{};  ///< their shape functions at the point, sum 1
  int count = 0;
  int triangle = -1;  ///< of the skin; one of those that share the point
  double area = 0;    ///< m^2 of the skin that it stands for
};

struct ContactPoints {
  std::vector<ContactPoint> points;  ///< (C)
  std::vector<int> first;            ///< by triangle, together with its edges' and corners' points:
  std::vector<int> of_triangle;      ///< of_triangle[first[t]] .. of_triangle[first[t + 1] - 1]
};

/// @param boundary  boundary_of(mesh); of a mesh with 10-node tetrahedra the points lie on its
///                  curved faces
/// @param spacing   m, > 0
[[nodiscard]] ContactPoints contact_points(const TetMesh& mesh, const Boundary& boundary,
                                           double spacing);

/// The point's place. @param positions  (3 x N) of the deformed nodes, m
[[nodiscard]] Eigen::Vector3d place(const ContactPoint& point, const Eigen::Matrix3Xd& positions);

}  // namespace palpable
