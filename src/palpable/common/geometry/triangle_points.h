/// @file
/// Points distributed over a triangle surface: on a grid in every triangle; points on edges and at
/// corners are shared by the triangles that meet there.
///
///   V  vertices     T  triangles     C  points
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// A point of a surface: a mean of a triangle's corners, whose weights do not change as they move.
struct TrianglePoint {
  int triangle = 0;                                   ///< one of those that share the point
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< of its corners, >= 0, sum 1
  double area = 0;                                    ///< m^2, the point's share of the surface
};

struct TrianglePoints {
  std::vector<TrianglePoint> points;  ///< (C)
  /// The points of triangle t, with those on its edges and corners, are
  /// of_triangle[first[t]] .. of_triangle[first[t + 1] - 1].
  std::vector<int> first;
  std::vector<int> of_triangle;
};

/// Points at every corner, along every edge and inside every triangle.
/// @param spacing  m, > 0: largest distance between neighbouring points along an edge
[[nodiscard]] TrianglePoints triangle_points(const SurfaceMesh& surface, double spacing);

}  // namespace palpable
