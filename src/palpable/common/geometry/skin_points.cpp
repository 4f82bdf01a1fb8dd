#include "palpable/common/geometry/skin_points.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/triangle_points.h"

#include <algorithm>
#include <cstddef>

namespace palpable {
namespace {

// Leaves out the corners without weight.
SkinPoint skin_point(const SurfaceMesh& skin, const TrianglePoint& from) {
  SkinPoint point;
  std::size_t count = 0;
  for (int k = 0; k < 3; ++k) {
    if (from.weights[k] == 0.0) continue;
    point.weights[static_cast<int>(count)] = static_cast<float>(from.weights[k]);
    point.corners[count++] = skin.triangles(k, from.triangle);
  }
  for (std::size_t k = count; k < 3; ++k) point.corners[k] = point.corners[count - 1];
  point.area = static_cast<float>(from.area);
  return point;
}

}  // namespace

std::vector<SkinPoint> skin_points(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
                                   double spacing) {
  PALPABLE_EXPECT(static_cast<int>(fixed.size()) == skin.vertex_count(),
                  "each vertex is held or not");
  std::vector<SkinPoint> points;
  for (const TrianglePoint& from : triangle_points(skin, spacing).points) {
    const SkinPoint point = skin_point(skin, from);
    const bool free = std::any_of(point.corners.begin(), point.corners.end(),
                                  [&](int v) { return fixed[v] == 0; });
    if (free) points.push_back(point);
  }
  const auto is_corner = [](const SkinPoint& point) { return point.weights[0] == 1.0f; };
  const auto others = std::stable_partition(points.begin(), points.end(), is_corner);
  std::sort(points.begin(), others,
            [](const SkinPoint& a, const SkinPoint& b) { return a.corners[0] < b.corners[0]; });
  return points;
}

Eigen::Matrix3Xf places_of(std::span<const SkinPoint> points, const Eigen::Matrix3Xf& vertices) {
  Eigen::Matrix3Xf places(3, std::ssize(points));
  for (std::size_t p = 0; p < points.size(); ++p) {
    places.col(static_cast<Eigen::Index>(p)) = points[p].at(vertices);
  }
  return places;
}

}  // namespace palpable
