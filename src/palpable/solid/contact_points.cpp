#include "palpable/solid/contact_points.h"

#include "palpable/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace palpable {

using Eigen::Vector3d;

namespace {

using Edge = std::pair<int, int>;  // nodes, the smaller first

Edge edge_of(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

// The middle nodes of a mesh's edges; empty where elements are linear.
std::map<Edge, int> middles_of(const TetMesh& mesh) {
  std::map<Edge, int> middles;
  if (!mesh.is_quadratic()) return middles;
  for (int e = 0; e < mesh.tet_count(); ++e) {
    for (int k = 0; k < 6; ++k) {
      middles.emplace(edge_of(mesh.tets(kTetEdges[k][0], e), mesh.tets(kTetEdges[k][1], e)),
                      mesh.edge_nodes(k, e));
    }
  }
  return middles;
}

class PointMaker {
 public:
  PointMaker(const TetMesh& mesh, const Boundary& boundary, double spacing)
      : mesh_(mesh), boundary_(boundary), spacing_(spacing), middles_(middles_of(mesh)) {}

  ContactPoints make() {
    const SurfaceMesh& skin = boundary_.surface;
    for (int t = 0; t < skin.triangle_count(); ++t) {
      triangle_ = t;
      for (int k = 0; k < 3; ++k) corners_[k] = boundary_.node_of_vertex[skin.triangles(k, t)];
      made_.first.push_back(static_cast<int>(made_.of_triangle.size()));
      add_triangle();
    }
    made_.first.push_back(static_cast<int>(made_.of_triangle.size()));
    share_areas();
    return std::move(made_);
  }

 private:
  [[nodiscard]] double length(int a, int b) const {
    return (mesh_.nodes.col(a) - mesh_.nodes.col(b)).norm();
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
    const auto [at, is_new] = edge_points_.try_emplace(edge_of(corners_[k], corners_[next]));
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

  // @param w  barycentric coordinates in the present triangle
  int add_point(const Vector3d& w) {
    ContactPoint point;
    point.triangle = triangle_;
    const auto add = [&](int node, double shape) {
      if (shape == 0.0) return;
      point.nodes[point.count] = node;
      point.shape[point.count++] = shape;
    };
    for (int k = 0; k < 3; ++k) {
      add(corners_[k], middles_.empty() ? w[k] : w[k] * (2.0 * w[k] - 1.0));
    }
    for (int k = 0; k < 3 && !middles_.empty(); ++k) {
      const int next = (k + 1) % 3;
      add(middles_.at(edge_of(corners_[k], corners_[next])), 4.0 * w[k] * w[next]);
    }
    made_.points.push_back(point);
    return static_cast<int>(made_.points.size()) - 1;
  }

  void share_areas() {
    const SurfaceMesh& skin = boundary_.surface;
    for (int t = 0; t < skin.triangle_count(); ++t) {
      const Vector3d a = skin.vertices.col(skin.triangles(0, t));
      const Vector3d b = skin.vertices.col(skin.triangles(1, t));
      const Vector3d c = skin.vertices.col(skin.triangles(2, t));
      const int count = made_.first[t + 1] - made_.first[t];
      const double share = 0.5 * (b - a).cross(c - a).norm() / count;
      for (int i = made_.first[t]; i < made_.first[t + 1]; ++i) {
        made_.points[made_.of_triangle[i]].area += share;
      }
    }
  }

  const TetMesh& mesh_;
  const Boundary& boundary_;
  double spacing_;
  std::map<Edge, int> middles_;
  std::map<int, int> corner_points_;
  std::map<Edge, std::vector<int>> edge_points_;
  ContactPoints made_;
  int triangle_ = -1;
  std::array<int, 3> corners_{};
};

}  // namespace

ContactPoints contact_points(const TetMesh& mesh, const Boundary& boundary, double spacing) {
  PALPABLE_EXPECT(spacing > 0.0, "a spacing above 0 m");
  return PointMaker(mesh, boundary, spacing).make();
}

Vector3d place(const ContactPoint& point, const Eigen::Matrix3Xd& positions) {
  Vector3d x = Vector3d::Zero();
  for (int k = 0; k < point.count; ++k) x += point.shape[k] * positions.col(point.nodes[k]);
  return x;
}

}  // namespace palpable
