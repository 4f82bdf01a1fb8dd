/// @file
/// The contact points of a body's skin.
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

/// (3 x C) m, positions of the points. @param vertices  (3 x V) m
[[nodiscard]] Eigen::Matrix3Xf places_of(std::span<const SkinPoint> points,
                                         const Eigen::Matrix3Xf& vertices);

}  // namespace palpable
