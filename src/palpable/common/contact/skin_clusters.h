/// @file
/// The contact points in small heaps, so that most of them need not be asked for in a frame: an
/// object that is far from a heap's middle is far from its points.
#pragma once

#include "palpable/common/geometry/skin_points.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

struct SkinCluster {
  int vertex = 0;    ///< of the skin, its middle
  float radius = 0;  ///< m, at rest: of the ball around the middle that holds its points
  int first = 0;     ///< its points: SkinClusters::order()[first] .. [last - 1]
  int last = 0;
};

class SkinClusters {
 public:
  /// @param vertices  (3 x V) m, at rest
  /// @param places    (3 x C) m, of the points at rest
  /// @param levels    (C) point_levels(): a heap's points are ordered by them, the coarsest first
  /// @param radius    m: no heap is larger, but for its outermost points' triangles
  SkinClusters(const Eigen::Matrix3Xf& vertices, std::span<const SkinPoint> points,
               const Eigen::Matrix3Xf& places, std::span<const float> levels, float radius);

  [[nodiscard]] std::span<const SkinCluster> clusters() const { return clusters_; }
  [[nodiscard]] std::span<const int> order() const { return order_; }

 private:
  std::vector<SkinCluster> clusters_;
  std::vector<int> order_;
};

}  // namespace palpable
