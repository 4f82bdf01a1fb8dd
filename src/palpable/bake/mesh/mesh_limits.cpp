#include "palpable/bake/mesh/mesh_limits.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/place_text.h"
#include "palpable/common/geometry/shells.h"

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace palpable {
namespace {

// Ratio of the extents with and without one vertex, above which the vertex is an error.
constexpr double kStrayFactor = 1e3;
// Ratio of a gap to the surface's diagonal, below which TetGen's tolerances merge points.
constexpr double kSmallestGap = 1e-7;

double area_of(const SurfaceMesh& surface) { return vertex_areas(surface).sum(); }

// Distance to a surface, by a tree over its triangles.
class DistanceTo {
 public:
  explicit DistanceTo(const SurfaceMesh& surface) {
    for (const auto& x : surface.vertices.colwise()) mesh_.add_vertex({x[0], x[1], x[2]});
    for (const auto& t : surface.triangles.colwise()) {
      mesh_.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2]));
    }
    tree_.rebuild(faces(mesh_).first, faces(mesh_).second, mesh_);
  }
  DistanceTo(const DistanceTo&) = delete;
  DistanceTo& operator=(const DistanceTo&) = delete;

  [[nodiscard]] double from(const Eigen::Vector3d& x) const {
    return std::sqrt(tree_.squared_distance({x[0], x[1], x[2]}));
  }

 private:
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  using Primitive = CGAL::AABB_face_graph_triangle_primitive<Mesh>;

  Mesh mesh_;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree_;
};

}  // namespace

void require_no_stray(const Eigen::Matrix3Xd& points, const std::string& name) {
  if (points.cols() < 3) return;
  const auto box_without = [&](Eigen::Index left_out) {
    Eigen::AlignedBox3d box;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      if (i != left_out) box.extend(points.col(i));
    }
    return box;
  };
  const double whole = box_without(-1).sizes().maxCoeff();
  // A point with such an effect is the first or the last one along some axis.
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Index least = 0, most = 0;
    points.row(axis).minCoeff(&least);
    points.row(axis).maxCoeff(&most);
    for (const Eigen::Index stray : {least, most}) {
      const Eigen::Vector3d rest = box_without(stray).sizes();
      if (rest.maxCoeff() * kStrayFactor >= whole) continue;
      const Eigen::Vector3d x = points.col(stray);
      throw Error(
          fmt::format("{}: the vertex at {} lies far off all others, which span {:.3g} x {:.3g} x "
                      "{:.3g} in the "
                      "file's unit: remove it in a mesh editor",
                      name, place_text(x, told_apart(points)), rest[0], rest[1], rest[2]));
    }
  }
}

double estimated_nodes(const SurfaceMesh& surface, double edge, double inner_edge) {
  PALPABLE_EXPECT(edge > 0.0 && inner_edge > 0.0, "edges are positive");
  return 1.15 * area_of(surface) / (edge * edge) +
         1.35 * enclosed_volume(surface) / std::pow(inner_edge, 3);
}

void require_meshable(const SurfaceMesh& surface, double edge, double inner_edge,
                      const std::string& name) {
  const double nodes = estimated_nodes(surface, edge, inner_edge);
  if (nodes <= kMostNodes) return;
  // Lengthens both edges by one factor, or the inner one alone where the skin has few nodes.
  const double of_skin = estimated_nodes(surface, edge, std::numeric_limits<double>::infinity());
  const bool inside = inner_edge < edge && of_skin < 0.5 * kMostNodes;
  const auto fits = [&](double factor) {
    return estimated_nodes(surface, inside ? edge : factor * edge, factor * inner_edge) <=
           kMostNodes;
  };
  double low = 1.0, high = 2.0;
  while (!fits(high)) high *= 2.0;
  while (high - low > 1e-3 * low) {
    const double factor = 0.5 * (low + high);
    (fits(factor) ? high : low) = factor;
  }
  throw Error(fmt::format(
      "{0}: {1}edges of {2:.3g} m make some {3:.2g} nodes, more than the {4:.0f} million that are "
      "bearable; {1}edges of {5:.2g} m would do (is the body as large as you think, {6:.3g} m^3?)",
      name, inside ? "inner " : "", inside ? inner_edge : edge, nodes, 1e-6 * kMostNodes,
      1.05 * high * (inside ? inner_edge : edge), enclosed_volume(surface)));
}

void require_wrappable(const SurfaceMesh& surface, double size, const std::string& name) {
  // The wrap has a vertex for sqrt(3)/2 size^2, as an even triangulation has.
  const double nodes = estimated_nodes(surface, size, std::numeric_limits<double>::infinity());
  if (nodes <= kMostNodes) return;
  throw Error(fmt::format(
      "{}: a wrap of {:.3g} m around {:.3g} m^2 has some {:.2g} vertices, more than the {:.0f} "
      "million that are bearable; {:.2g} m would do (is the body as large as you think?)",
      name, size, area_of(surface), nodes, 1e-6 * kMostNodes,
      1.05 * size * std::sqrt(nodes / kMostNodes)));
}

void require_same_volume(const SurfaceMesh& before, double volume, double edge,
                         const std::string& name) {
  const double wanted = enclosed_volume(before), radius = 3.0 * wanted / area_of(before);
  const double share = edge / radius, facets = std::min(0.5 * share * share, 0.1);
  if (std::abs(volume - wanted) <= (0.01 + facets) * wanted) return;
  throw Error(
      fmt::format("{}: encloses {:.4g} m^3, but its mesh with an edge of {:.3g} m {:.4g} "
                  "m^3; try a shorter edge",
                  name, wanted, edge, volume));
}

void require_gaps(const SurfaceMesh& surface, const std::string& name) {
  const std::vector<std::vector<int>> shells = shells_of(surface);
  if (shells.size() < 2) return;
  const double smallest = kSmallestGap * box_of(surface).diagonal().norm();
  std::vector<SurfaceMesh> parts;
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const std::vector<int>& shell : shells) {
    parts.push_back(surface_of(surface, shell));
    boxes.push_back(box_of(parts.back()));
  }
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::optional<DistanceTo> to_part;
    for (std::size_t q = 0; q < parts.size(); ++q) {
      // Most of a thousand shells are far from this one.
      if (q == p || boxes[p].exteriorDistance(boxes[q]) >= smallest) continue;
      if (!to_part) to_part.emplace(parts[p]);
      for (const auto& x : parts[q].vertices.colwise()) {
        const double gap = to_part->from(x);
        if (gap >= smallest) continue;
        throw Error(fmt::format(
            "{}: two closed shells come within {:.2g} m of each other at {}, too near to fill what "
            "is between them; move them apart or join them in a mesh editor, or let 'wrap' in a "
            "body's description join them",
            name, gap, place_text(x, told_apart(surface.vertices))));
      }
    }
  }
}

}  // namespace palpable
