#include "palpable/common/geometry/skin_points.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace palpable {

using Eigen::Vector3d;

namespace {

class PointMaker {
 public:
  PointMaker(const SurfaceMesh& surface, double spacing) : surface_(surface), spacing_(spacing) {}

  TrianglePoints make() {
    for (int t = 0; t < surface_.triangle_count(); ++t) {
      triangle_ = t;
      for (int k = 0; k < 3; ++k) corners_[k] = surface_.triangles(k, t);
      made_.first.push_back(static_cast<int>(made_.of_triangle.size()));
      add_triangle();
    }
    made_.first.push_back(static_cast<int>(made_.of_triangle.size()));
    share_areas();
    return std::move(made_);
  }

 private:
  [[nodiscard]] double length(int a, int b) const {
    return (surface_.vertices.col(a) - surface_.vertices.col(b)).norm();
  }
  [[nodiscard]] int pieces_of(double length) const {
    return std::max(1, static_cast<int>(std::ceil(length / spacing_ - 1e-9)));
  }

  void add_triangle() {
    for (int k = 0; k < 3; ++k) add_corner(k);
    for (int k = 0; k < 3; ++k) add_edge(k);
    const double longest =
        std::max({length(corners_[0], corners_[1]), length(corners_[1], corners_[2]),
                  length(corners_[2], corners_[0])});
    const int pieces = pieces_of(longest);
    for (int i = 1; i < pieces; ++i) {
      for (int j = 1; j < pieces - i; ++j) {
        const double n = pieces;
        made_.of_triangle.push_back(add_point({(n - i - j) / n, i / n, j / n}));
      }
    }
  }

  void add_corner(int k) {
    const auto [at, is_new] = corner_points_.try_emplace(corners_[k], 0);
    if (is_new) at->second = add_point(Vector3d::Unit(k));
    made_.of_triangle.push_back(at->second);
  }

  void add_edge(int k) {
    const int next = (k + 1) % 3;
    const auto [at, is_new] = edge_points_.try_emplace(std::minmax(corners_[k], corners_[next]));
    if (is_new) {
      const int pieces = pieces_of(length(corners_[k], corners_[next]));
      for (int i = 1; i < pieces; ++i) {
        Vector3d weights = Vector3d::Zero();
        weights[next] = static_cast<double>(i) / pieces;
        weights[k] = 1.0 - weights[next];
        at->second.push_back(add_point(weights));
      }
    }
    for (const int point : at->second) made_.of_triangle.push_back(point);
  }

  int add_point(const Vector3d& weights) {
    made_.points.push_back({triangle_, weights, 0.0});
    return static_cast<int>(made_.points.size()) - 1;
  }

  void share_areas() {
    for (int t = 0; t < surface_.triangle_count(); ++t) {
      const Vector3d a = surface_.vertices.col(surface_.triangles(0, t));
      const Vector3d b = surface_.vertices.col(surface_.triangles(1, t));
      const Vector3d c = surface_.vertices.col(surface_.triangles(2, t));
      const int count = made_.first[t + 1] - made_.first[t];
      const double share = 0.5 * (b - a).cross(c - a).norm() / count;
      for (int i = made_.first[t]; i < made_.first[t + 1]; ++i) {
        made_.points[made_.of_triangle[i]].area += share;
      }
    }
  }

  const SurfaceMesh& surface_;
  double spacing_;
  std::map<int, int> corner_points_;
  std::map<std::pair<int, int>, std::vector<int>> edge_points_;  // the smaller vertex first
  TrianglePoints made_;
  int triangle_ = -1;
  std::array<int, 3> corners_{};
};

}  // namespace

TrianglePoints triangle_points(const SurfaceMesh& surface, double spacing) {
  PALPABLE_EXPECT(spacing > 0.0, "a spacing above 0 m");
  return PointMaker(surface, spacing).make();
}

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

Eigen::Matrix3Xf held_vertices(const Eigen::Matrix3Xf& vertices,
                               std::span<const std::uint8_t> fixed) {
  Eigen::Matrix3Xf held(3, std::count(fixed.begin(), fixed.end(), std::uint8_t{1}));
  Eigen::Index count = 0;
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
    if (fixed[static_cast<std::size_t>(v)] == 1) held.col(count++) = vertices.col(v);
  }
  return held;
}

Eigen::Matrix3Xf places_of(std::span<const SkinPoint> points, const Eigen::Matrix3Xf& vertices) {
  Eigen::Matrix3Xf places(3, std::ssize(points));
  for (std::size_t p = 0; p < points.size(); ++p) {
    places.col(static_cast<Eigen::Index>(p)) = points[p].at(vertices);
  }
  return places;
}

}  // namespace palpable
