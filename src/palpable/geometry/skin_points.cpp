#include "palpable/geometry/skin_points.h"

#include "palpable/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace palpable {
namespace {

using Eigen::Vector3f;

class PointSet {
 public:
  PointSet(const SurfaceMesh& skin, double spacing) : skin_(skin), spacing_(spacing) {}

  std::vector<SkinPoint> make() {
    for (int v = 0; v < skin_.vertex_count(); ++v) {
      points_.push_back({{v, v, v}, Vector3f::UnitX(), 0.0f});
    }
    for (int t = 0; t < skin_.triangle_count(); ++t) add_triangle(t);
    return std::move(points_);
  }

 private:
  // In how many parts an edge is cut.
  [[nodiscard]] int parts(int a, int b) const {
    const double length = (skin_.vertices.col(a) - skin_.vertices.col(b)).norm();
    return std::max(1, static_cast<int>(std::ceil(length / spacing_)));
  }

  void add_triangle(int t) {
    const std::array<int, 3> corner{skin_.triangles(0, t), skin_.triangles(1, t),
                                    skin_.triangles(2, t)};
    std::vector<int> mine(corner.begin(), corner.end());
    int most = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = corner[k], b = corner[(k + 1) % 3];
      most = std::max(most, parts(a, b));
      const int first = first_on_edge(std::min(a, b), std::max(a, b));
      for (int i = 0; i + 1 < parts(a, b); ++i) mine.push_back(first + i);
    }
    for (int i = 1; i < most; ++i) {
      for (int j = 1; i + j < most; ++j) {
        mine.push_back(static_cast<int>(points_.size()));
        points_.push_back(
            {corner, Eigen::Vector3i(i, j, most - i - j).cast<float>() / static_cast<float>(most),
             0.0f});
      }
    }
    const Eigen::Vector3d a = skin_.vertices.col(corner[0]);
    const Eigen::Vector3d ab = skin_.vertices.col(corner[1]) - a;
    const Eigen::Vector3d ac = skin_.vertices.col(corner[2]) - a;
    const double area = 0.5 * ab.cross(ac).norm() / static_cast<double>(mine.size());
    for (const int p : mine) points_[p].area += static_cast<float>(area);
  }

  // Of the points inside an edge; they are made when the first of its triangles comes.
  int first_on_edge(int a, int b) {
    const auto [at, is_new] = of_edge_.try_emplace({a, b}, static_cast<int>(points_.size()));
    if (is_new) {
      const int count = parts(a, b);
      for (int i = 1; i < count; ++i) {
        const float share = static_cast<float>(i) / static_cast<float>(count);
        points_.push_back({{a, b, b}, Vector3f(1 - share, share, 0), 0.0f});
      }
    }
    return at->second;
  }

  const SurfaceMesh& skin_;
  double spacing_;
  std::vector<SkinPoint> points_;
  std::map<std::pair<int, int>, int> of_edge_;
};

}  // namespace

std::vector<SkinPoint> skin_points(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
                                   double spacing) {
  PALPABLE_EXPECT(spacing > 0, "a spacing is a length above 0");
  PALPABLE_EXPECT(static_cast<int>(fixed.size()) == skin.vertex_count(),
                  "each vertex is held or not");
  std::vector<SkinPoint> points = PointSet(skin, spacing).make();
  const auto held = [&](const SkinPoint& point) {
    for (int k = 0; k < 3; ++k) {
      if (point.weights[k] > 0 && fixed[point.corners[k]] == 0) return false;
    }
    return true;
  };
  points.erase(std::remove_if(points.begin(), points.end(), held), points.end());
  return points;
}

}  // namespace palpable
