#include "palpable/common/contact/skin_clusters.h"

#include "palpable/common/contact/point_grid.h"

#include <algorithm>
#include <cstddef>

namespace palpable {
SkinClusters::SkinClusters(const Eigen::Matrix3Xf& vertices, std::span<const SkinPoint> points,
                           const Eigen::Matrix3Xf& places, std::span<const float> levels,
                           float radius) {
  std::vector<char> taken(points.size(), 0);
  PointGrid grid(radius);
  for (std::size_t p = 0; p < points.size(); ++p) {
    grid.add(p, places.col(static_cast<Eigen::Index>(p)));
  }
  for (std::size_t seed = 0; seed < points.size(); ++seed) {
    if (taken[seed] != 0) continue;
    // The middle is the corner with the largest weight of the first point that is left.
    int corner = 0;
    points[seed].weights.maxCoeff(&corner);
    SkinCluster cluster{points[seed].corners[static_cast<std::size_t>(corner)], 0,
                        static_cast<int>(order_.size()), 0};
    const Eigen::Vector3f middle = vertices.col(cluster.vertex);
    const auto take = [&](std::size_t p) {
      const float distance = (places.col(static_cast<Eigen::Index>(p)) - middle).norm();
      if (taken[p] != 0 || (distance > radius && p != seed)) return;
      taken[p] = 1;
      order_.push_back(static_cast<int>(p));
      cluster.radius = std::max(cluster.radius, distance);
    };
    take(seed);  // it may be farther from the middle than `radius`
    grid.any_near(middle, [&](std::size_t p) {
      take(p);
      return false;
    });
    cluster.last = static_cast<int>(order_.size());
    std::sort(order_.begin() + cluster.first, order_.end(),
              [&](int a, int b) { return levels[a] != levels[b] ? levels[a] > levels[b] : a < b; });
    clusters_.push_back(cluster);
  }
}

}  // namespace palpable
