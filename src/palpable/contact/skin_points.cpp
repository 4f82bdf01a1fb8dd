#include "palpable/contact/skin_points.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

int parts_of(double length, double spacing) {
  return std::max(1, static_cast<int>(std::ceil(length / spacing - 1e-9)));
}

float share(int part, int parts) { return static_cast<float>(part) / static_cast<float>(parts); }

}  // namespace

std::vector<SkinPoint> skin_points(const SurfaceMesh& surface, std::span<const std::uint8_t> fixed,
                                   double spacing) {
  PALPABLE_EXPECT(spacing > 0, "points are some way apart");
  PALPABLE_EXPECT(std::ssize(fixed) == surface.vertices.cols(), "each vertex is fixed or not");
  std::vector<SkinPoint> points;
  const auto add = [&](const SkinPoint& point) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (point.weights[k] > 0 && fixed[point.corners[k]] == 0) {
        points.push_back(point);
        return;
      }
    }
  };
  std::vector<char> used(fixed.size(), 0);
  for (const int vertex : surface.triangles.reshaped()) {
    if (used[vertex] == 0) add({{vertex, vertex, vertex}, {1, 0, 0}});
    used[vertex] = 1;
  }
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i corner = surface.triangles.col(t);
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      const int a = corner[k], b = corner[(k + 1) % 3];
      const double length = (surface.vertices.col(b) - surface.vertices.col(a)).norm();
      longest = std::max(longest, length);
      if (a > b) continue;  // the triangle on the edge's other side has it as (b, a)
      const int parts = parts_of(length, spacing);
      for (int i = 1; i < parts; ++i) {
        add({{a, b, b}, {share(parts - i, parts), share(i, parts), 0}});
      }
    }
    const int parts = parts_of(longest, spacing);
    for (int i = 1; i < parts; ++i) {
      for (int j = 1; i + j < parts; ++j) {
        add({{corner[0], corner[1], corner[2]},
             {share(parts - i - j, parts), share(i, parts), share(j, parts)}});
      }
    }
  }
  return points;
}

}  // namespace palpable
