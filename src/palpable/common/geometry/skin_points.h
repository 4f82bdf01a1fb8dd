/// @file
/// The points of a body's skin that nothing may enter.
///
///   V  vertices of the skin     T  triangles     C  contact points
///
/// Corners alone would let a pencil's tip, which is smaller than a triangle, pass between them:
/// with contact at corners a fingertip is answered wrong by 7-12 % and a cup's rim by 37-59 %,
/// however good the model. So points lie at the corners, along the edges and inside the triangles.
/// Between points `spacing` apart an object of radius r enters by spacing^2 / (8 r) at most where
/// the skin is flat.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// A point of the skin: a fixed mean of a triangle's corners, whatever they do.
struct SkinPoint {
  std::array<int, 3> corners{};                       ///< vertices; equal ones where fewer matter
  Eigen::Vector3f weights = Eigen::Vector3f::Zero();  ///< >= 0, sum 1; a vertex has one weight 1
  float area = 0;                                     ///< m^2 of the skin that it stands for

  /// @param x  (3 x V) of the vertices
  [[nodiscard]] Eigen::Vector3f at(const Eigen::Matrix3Xf& x) const {
    return weights[0] * x.col(corners[0]) + weights[1] * x.col(corners[1]) +
           weights[2] * x.col(corners[2]);
  }
};

/// @param fixed    (V) 1 where the support holds the vertex: a point without a free corner is left
///                 out, for it cannot give way
/// @param spacing  m, > 0: of neighbouring points along an edge, at most
/// @return (C) the corners first, in their order, then the others
[[nodiscard]] std::vector<SkinPoint> skin_points(const SurfaceMesh& skin,
                                                 std::span<const std::uint8_t> fixed,
                                                 double spacing);

/// (3 x C) m, where points are. @param vertices  (3 x V) m
[[nodiscard]] Eigen::Matrix3Xf places_of(std::span<const SkinPoint> points,
                                         const Eigen::Matrix3Xf& vertices);

}  // namespace palpable
