#include "palpable/touch/skin_clusters.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>

namespace palpable {
namespace {

// Points by the cube of a grid that they lie in. All that are within one edge of a place lie in the
// 27 cubes around it.
class Cubes {
 public:
  Cubes(const Eigen::Matrix3Xf& places, float edge) : edge_(edge) {
    for (Eigen::Index p = 0; p < places.cols(); ++p) {
      cubes_[cube_of(places.col(p))].push_back(static_cast<std::size_t>(p));
    }
  }

  template <class Tell>
  void for_each_near(const Eigen::Vector3f& place, const Tell& tell) const {
    const Cube middle = cube_of(place);
    for (int k = 0; k < 27; ++k) {
      const auto cube =
          cubes_.find({middle[0] + k % 3 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k / 9 - 1});
      if (cube == cubes_.end()) continue;
      for (const std::size_t p : cube->second) tell(p);
    }
  }

 private:
  using Cube = std::array<int, 3>;
  [[nodiscard]] Cube cube_of(const Eigen::Vector3f& x) const {
    const Eigen::Array3i cube = (x.array() / edge_).floor().cast<int>();
    return {cube[0], cube[1], cube[2]};
  }

  float edge_;
  std::map<Cube, std::vector<std::size_t>> cubes_;
};

}  // namespace

SkinClusters::SkinClusters(const Eigen::Matrix3Xf& vertices, std::span<const SkinPoint> points,
                           const Eigen::Matrix3Xf& places, std::span<const float> levels,
                           float radius) {
  std::vector<char> taken(points.size(), 0);
  const Cubes cubes(places, radius);
  for (std::size_t seed = 0; seed < points.size(); ++seed) {
    if (taken[seed] != 0) continue;
    // Around the heaviest corner of the first point that is left.
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
    take(seed);  // it may be farther from its corner than all others
    cubes.for_each_near(middle, take);
    cluster.last = static_cast<int>(order_.size());
    std::sort(order_.begin() + cluster.first, order_.end(),
              [&](int a, int b) { return levels[a] != levels[b] ? levels[a] > levels[b] : a < b; });
    clusters_.push_back(cluster);
  }
}

}  // namespace palpable
