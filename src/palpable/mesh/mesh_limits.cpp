#include "palpable/mesh/mesh_limits.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"
#include "palpable/geometry/shells.h"

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpable {
namespace {

constexpr double kSmallestGap = 1e-7;  // of the diagonal: below, TetGen's tolerances merge points

double area_of(const SurfaceMesh& surface) { return vertex_areas(surface).sum(); }

}  // namespace

double estimated_nodes(const SurfaceMesh& surface, double edge, double inner_edge) {
  PALPABLE_EXPECT(edge > 0.0 && inner_edge > 0.0, "edges are positive");
  return 1.15 * area_of(surface) / (edge * edge) +
         1.35 * enclosed_volume(surface) / std::pow(inner_edge, 3);
}

void require_meshable(const SurfaceMesh& surface, double edge, double inner_edge,
                      const std::string& name) {
  const double nodes = estimated_nodes(surface, edge, inner_edge);
  if (nodes <= kMostNodes) return;
  // Longer edges by one factor, both; the count falls with it.
  double low = 1.0, high = 2.0;
  while (estimated_nodes(surface, high * edge, high * inner_edge) > kMostNodes) high *= 2.0;
  while (high - low > 1e-3 * low) {
    const double factor = 0.5 * (low + high);
    const bool fits = estimated_nodes(surface, factor * edge, factor * inner_edge) <= kMostNodes;
    (fits ? high : low) = factor;
  }
  throw Error(fmt::format(
      "{}: edges of {:.3g} m make some {:.2g} nodes, more than the {:.0f} million that are "
      "bearable; an edge of {:.2g} m would do (is the body as large as you think, {:.3g} m^3?)",
      name, edge, nodes, 1e-6 * kMostNodes, 1.05 * high * edge, enclosed_volume(surface)));
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
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  using Primitive = CGAL::AABB_face_graph_triangle_primitive<Mesh>;
  using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

  const Eigen::Vector3d extent =
      surface.vertices.rowwise().maxCoeff() - surface.vertices.rowwise().minCoeff();
  const double smallest = kSmallestGap * extent.norm();
  for (std::size_t s = 0; s < shells.size(); ++s) {
    const SurfaceMesh part = surface_of(surface, shells[s]);
    Mesh mesh;
    for (const auto& x : part.vertices.colwise()) mesh.add_vertex({x[0], x[1], x[2]});
    for (const auto& t : part.triangles.colwise()) {
      mesh.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2]));
    }
    const Tree tree(faces(mesh).first, faces(mesh).second, mesh);
    for (std::size_t other = 0; other < shells.size(); ++other) {
      if (other == s) continue;
      const SurfaceMesh neighbour = surface_of(surface, shells[other]);
      for (const auto& x : neighbour.vertices.colwise()) {
        const double gap = std::sqrt(tree.squared_distance({x[0], x[1], x[2]}));
        if (gap >= smallest) continue;
        throw Error(fmt::format(
            "{}: two closed shells come within {:.2g} m of each other at ({:.4g}, {:.4g}, {:.4g}), "
            "too near to fill what is between them; move them apart or join them in a mesh editor",
            name, gap, x[0], x[1], x[2]));
      }
    }
  }
}

}  // namespace palpable
