/// @file
/// Points all over a triangle surface: on a grid over every triangle, shared along edges and at
/// corners.
///
///   V  vertices     T  triangles     C  points
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// A point of a surface: a fixed mean of a triangle's corners, whatever they do.
struct TrianglePoint {
  int triangle = 0;                                   ///< one of those that share the point
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< of its corners, >= 0, sum 1
  double area = 0;                                    ///< m^2 of the surface that it stands for
};

struct TrianglePoints {
  std::vector<TrianglePoint> points;  ///< (C)
  std::vector<int> first;        ///< by triangle, together with its edges' and corners' points:
  std::vector<int> of_triangle;  ///< of_triangle[first[t]] .. of_triangle[first[t + 1] - 1]
};

/// Every corner of a triangle, points along its edges and inside it, none farther than `spacing`
/// from the next along an edge.
/// @param spacing  m, > 0
[[nodiscard]] TrianglePoints triangle_points(const SurfaceMesh& surface, double spacing);

}  // namespace palpable
