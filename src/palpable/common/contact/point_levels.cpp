#include "palpable/common/contact/point_levels.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/contact/point_grid.h"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>

namespace palpable {

using Eigen::Vector3f;

std::vector<float> point_levels(const SurfaceMesh& skin, std::span<const SkinPoint> points,
                                double coarsest, double finest) {
  PALPABLE_EXPECT(finest > 0 && finest <= coarsest, "levels from coarse to fine");
  const Eigen::Matrix3Xf vertices = skin.vertices.cast<float>();
  Eigen::Matrix3Xf normals(3, vertices.cols());
  vertex_normals(vertices, skin.triangles, normals);
  std::vector<Vector3f> places, outwards;
  for (const SkinPoint& point : points) {
    places.push_back(point.at(vertices));
    outwards.push_back(point.at(normals));
  }
  std::vector<float> levels(points.size(), 0.0f);
  for (double s = coarsest; s > 0.999 * finest; s /= std::sqrt(2.0)) {
    const auto within = static_cast<float>(s);
    PointGrid chosen(within);
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (levels[p] > 0) chosen.add(p, places[p]);
    }
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (levels[p] > 0) continue;
      // Only points on the same side of the body count.
      const bool has_near = chosen.any_near(places[p], [&](std::size_t other) {
        return (places[other] - places[p]).squaredNorm() < within * within &&
               outwards[other].dot(outwards[p]) > 0;
      });
      if (has_near) continue;
      levels[p] = within;
      chosen.add(p, places[p]);
    }
  }
  return levels;
}

}  // namespace palpable
