/// @file
/// The contact points in small clusters, so that most of them need not be queried in a frame: an
/// obstacle that is far from a cluster's middle is far from all its points.
#pragma once

#include "palpable/common/geometry/skin_points.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

struct SkinCluster {
  int vertex = 0;    ///< of the skin: the cluster's middle
  float radius = 0;  ///< m, at rest: largest distance of a point from the middle
  int first = 0;     ///< its points: SkinClusters::order()[first] .. [last - 1]
  int last = 0;
};

class SkinClusters {
 public:
  /// @param vertices  (3 x V) m, at rest
  /// @param places    (3 x C) m, of the points at rest
  /// @param levels    (C) point_levels(): a cluster's points are ordered by them, the coarsest
  ///                  first
  /// @param radius    m, largest radius of a cluster; only its first point may be farther away
  SkinClusters(const Eigen::Matrix3Xf& vertices, std::span<const SkinPoint> points,
               const Eigen::Matrix3Xf& places, std::span<const float> levels, float radius);

  [[nodiscard]] std::span<const SkinCluster> clusters() const { return clusters_; }
  [[nodiscard]] std::span<const int> order() const { return order_; }

 private:
  std::vector<SkinCluster> clusters_;
  std::vector<int> order_;
};

}  // namespace palpable
