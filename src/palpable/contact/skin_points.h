/// @file
/// Points all over a body's skin at which contact looks for real things. Vertices alone do not do:
/// the tip of a pencil is smaller than a triangle.
#pragma once

#include "palpable/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// A point of the skin that moves with it: x = sum of weights[i] x_of(corners[i]).
struct SkinPoint {
  std::array<int, 3> corners{};    ///< vertices of one triangle
  std::array<float, 3> weights{};  ///< >= 0, sum 1; a vertex has one weight 1

  /// @param x  (3 x V) of the vertices
  [[nodiscard]] Eigen::Vector3f at(const Eigen::Matrix3Xf& x) const {
    return weights[0] * x.col(corners[0]) + weights[1] * x.col(corners[1]) +
           weights[2] * x.col(corners[2]);
  }
};

/// The vertices of the triangles, then points on the edges and inside the triangles. Neighbours are
/// at most `spacing` apart, so nothing of the skin is farther than 0.58 spacings from a point of an
/// equilateral triangle. Points that only fixed vertices carry are left out: they cannot move.
/// @param fixed    (V) not 0 where the support holds a vertex
/// @param spacing  m, > 0
[[nodiscard]] std::vector<SkinPoint> skin_points(const SurfaceMesh& surface,
                                                 std::span<const std::uint8_t> fixed,
                                                 double spacing);

}  // namespace palpable
