#include "palpable/bake/solid/contact_points.h"

#include "palpable/common/geometry/skin_points.h"

#include <algorithm>
#include <map>
#include <utility>

namespace palpable {

using Eigen::Vector3d;

namespace {

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

Vector3d position_of(const ContactPoint& point, const Eigen::Matrix3Xd& positions) {
  Vector3d x = Vector3d::Zero();
  for (int k = 0; k < point.count; ++k) x += point.shape[k] * positions.col(point.nodes[k]);
  return x;
}

}  // namespace palpable
