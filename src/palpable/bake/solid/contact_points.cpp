#include "palpable/bake/solid/contact_points.h"

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace palpable {

using Eigen::Vector3d;

namespace {

constexpr double kMostPoints = 2e6;  // contact points of a body; they take some 1 GB

using Edge = std::pair<int, int>;  // nodes, the smaller first

Edge edge_of(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

// The middle node of each edge of a mesh; empty for 4-node elements.
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

}  // namespace

ContactPoints contact_points(const TetMesh& mesh, const Boundary& boundary, double spacing) {
  TrianglePoints made = triangle_points(boundary.surface, spacing);
  const std::map<Edge, int> middles = middles_of(mesh);
  ContactPoints result{{}, std::move(made.first), std::move(made.of_triangle)};
  for (const TrianglePoint& on_skin : made.points) {
    ContactPoint point;
    point.triangle = on_skin.triangle;
    point.area = on_skin.area;
    const Vector3d& w = on_skin.weights;
    const auto corner = [&](int k) {
      return boundary.node_of_vertex[boundary.surface.triangles(k, on_skin.triangle)];
    };
    const auto add = [&](int node, double shape) {
      if (shape == 0.0) return;
      point.nodes[point.count] = node;
      point.shape[point.count++] = shape;
    };
    for (int k = 0; k < 3; ++k) add(corner(k), middles.empty() ? w[k] : w[k] * (2.0 * w[k] - 1.0));
    for (int k = 0; k < 3 && !middles.empty(); ++k) {
      const int next = (k + 1) % 3;
      add(middles.at(edge_of(corner(k), corner(next))), 4.0 * w[k] * w[next]);
    }
    result.points.push_back(point);
  }
  return result;
}

double contact_spacing(double wanted, const SurfaceMesh& skin, double radius) {
  const double spacing =
      wanted > 0.0 ? wanted : std::min(0.5 * radius, mean_edge_length(skin) / 3.0);
  double area = 0.0;
  for (int t = 0; t < skin.triangle_count(); ++t) {
    const Vector3d a = skin.vertices.col(skin.triangles(0, t));
    const Vector3d b = skin.vertices.col(skin.triangles(1, t));
    const Vector3d c = skin.vertices.col(skin.triangles(2, t));
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  const double count = area / (spacing * spacing);
  if (count > kMostPoints) {
    throw Error(fmt::format(
        "contact points every {:.3g} mm would be {:.2g} million on this skin; at most {:.0f} "
        "million are possible: ask for a larger spacing, {:.2g} mm or more",
        1e3 * spacing, 1e-6 * count, 1e-6 * kMostPoints, 1e3 * std::sqrt(area / kMostPoints)));
  }
  return spacing;
}

Eigen::VectorXd node_stiffnesses(const BlockMatrix& K, const std::vector<int>& free_nodes,
                                 int nodes) {
  Eigen::VectorXd stiffness = Eigen::VectorXd::Zero(nodes);
  for (int m = 0; m < K.pattern().rows(); ++m) {
    stiffness[free_nodes[static_cast<std::size_t>(m)]] =
        K.block(K.pattern().find(m, m)).trace() / 3.0;
  }
  const double mean = stiffness.sum() / static_cast<double>(free_nodes.size());
  return (stiffness.array() == 0.0).select(mean, stiffness);
}

Eigen::VectorXd means_at_points(const ContactPoints& points, const Eigen::VectorXd& of_nodes) {
  Eigen::VectorXd means(static_cast<Eigen::Index>(points.points.size()));
  for (Eigen::Index i = 0; i < means.size(); ++i) {
    const ContactPoint& point = points.points[i];
    double weighted = 0.0, weights = 0.0;
    for (int k = 0; k < point.count; ++k) {
      weighted += std::abs(point.shape[k]) * of_nodes[point.nodes[k]];
      weights += std::abs(point.shape[k]);
    }
    means[i] = weighted / weights;
  }
  return means;
}

Vector3d position_of(const ContactPoint& point, const Eigen::Matrix3Xd& positions) {
  Vector3d x = Vector3d::Zero();
  for (int k = 0; k < point.count; ++k) x += point.shape[k] * positions.col(point.nodes[k]);
  return x;
}

}  // namespace palpable
