/// @file
/// Points distributed over a surface, and the contact points of a body's skin, which are made from
/// them.
///
///   V  vertices of the skin     T  triangles     C  contact points
///
/// If contact were checked at the corners of triangles alone, a pencil's tip, which is smaller than
/// a triangle, would pass between them: then the response to a fingertip is wrong by 7-12 % and
/// that to a cup's rim by 37-59 %, however good the model of the body is. So contact points lie at
/// the corners, along the edges and inside the triangles. Between points `spacing` apart an object
/// of radius r can penetrate a flat skin by at most spacing^2 / (8 r).
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// A point of a surface: a mean of a triangle's corners, whose weights do not change as they move.
struct TrianglePoint {
  int triangle = 0;                                   ///< one of those that share the point
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< of its corners, >= 0, sum 1
  double area = 0;                                    ///< m^2, the point's share of the surface
};

/// Points distributed over a triangle surface: on a grid in every triangle; points on edges and at
/// corners are shared by the triangles that meet there.
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

/// A point of the skin: a mean of a triangle's corners, whose weights do not change as they move.
struct SkinPoint {
  std::array<int, 3> corners{};                       ///< vertices; repeated if fewer have weight
  Eigen::Vector3f weights = Eigen::Vector3f::Zero();  ///< >= 0, sum 1; a vertex has one weight 1
  float area = 0;                                     ///< m^2, the point's share of the skin

  /// @param x  (3 x V) of the vertices
  [[nodiscard]] Eigen::Vector3f at(const Eigen::Matrix3Xf& x) const {
    return weights[0] * x.col(corners[0]) + weights[1] * x.col(corners[1]) +
           weights[2] * x.col(corners[2]);
  }
};

/// @param fixed    (V) 1 where the support holds the vertex. Points without a free corner are left
///                 out, since they cannot move
/// @param spacing  m, > 0: largest distance between neighbouring points along an edge
/// @return (C) the corners first, in their order, then the others
[[nodiscard]] std::vector<SkinPoint> skin_points(const SurfaceMesh& skin,
                                                 std::span<const std::uint8_t> fixed,
                                                 double spacing);

/// (3 x H) m, the vertices that the support holds, in their order. @param vertices  (3 x V) m
/// @param fixed  (V) 1 where the support holds the vertex
[[nodiscard]] Eigen::Matrix3Xf held_vertices(const Eigen::Matrix3Xf& vertices,
                                             std::span<const std::uint8_t> fixed);

/// (3 x C) m, positions of the points. @param vertices  (3 x V) m
[[nodiscard]] Eigen::Matrix3Xf places_of(std::span<const SkinPoint> points,
                                         const Eigen::Matrix3Xf& vertices);

}  // namespace palpable
