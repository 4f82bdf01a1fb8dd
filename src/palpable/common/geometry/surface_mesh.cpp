#include "palpable/common/geometry/surface_mesh.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/place_text.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace palpable {
namespace {

using Eigen::Vector3d;

struct HalfEdge {
  int low, high;  // vertices, low < high
  bool forward;   // the triangle traverses the edge from low to high
  int triangle;
};

std::vector<HalfEdge> sorted_half_edges(const SurfaceMesh& surface,
                                        const std::vector<bool>& usable) {
  std::vector<HalfEdge> edges;
  edges.reserve(static_cast<std::size_t>(surface.triangle_count()) * 3);
  for (int t = 0; t < surface.triangle_count(); ++t) {
    if (!usable[t]) continue;
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles(k, t);
      const int b = surface.triangles((k + 1) % 3, t);
      edges.push_back({std::min(a, b), std::max(a, b), a < b, t});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& x, const HalfEdge& y) {
    return std::pair(x.low, x.high) < std::pair(y.low, y.high);
  });
  return edges;
}

}  // namespace

std::string WatertightReport::describe() const {
  if (watertight()) return "watertight";
  std::string what;
  const auto add = [&](int count, const char* one, const char* many) {
    if (count == 0) return;
    if (!what.empty()) what += ", ";
    what += fmt::format("{} {}", count, count == 1 ? one : many);
  };
  add(open_edges, "open edge", "open edges");
  add(crowded_edges, "edge of more than two triangles", "edges of more than two triangles");
  add(flipped_edges, "edge between opposite orientations", "edges between opposite orientations");
  add(bad_triangles, "degenerate triangle", "degenerate triangles");
  if (what.empty() && inside_out) {
    return "not watertight: the triangles face inwards; flip their orientation";
  }
  return fmt::format(
      "not watertight: {}; the first at {}; {} in a mesh editor, or let 'wrap' in a body's "
      "description build one closed surface around them",
      what, place_text(first_defect, apart),
      crowded_edges > 0 ? "separate what shares those edges, or join it to one solid,"
                        : "close the holes and remove the duplicates");
}

WatertightReport check_watertight(const SurfaceMesh& surface) {
  WatertightReport report;
  bool found = false;
  const auto defect_at = [&](const Vector3d& x) {
    if (!found) report.first_defect = x;
    found = true;
  };

  const int N = surface.vertex_count();
  std::vector<bool> usable(surface.triangle_count(), true);
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const Eigen::Vector3i v = surface.triangles.col(t);
    const bool in_range = v.minCoeff() >= 0 && v.maxCoeff() < N;
    bool bad = !in_range || v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
    if (!bad) {
      const Vector3d a = surface.vertices.col(v[0]);
      const Vector3d n = (surface.vertices.col(v[1]) - a).cross(surface.vertices.col(v[2]) - a);
      bad = !(n.squaredNorm() > 0.0) || !n.allFinite();
    }
    if (bad) {
      usable[t] = false;
      ++report.bad_triangles;
      if (in_range) defect_at(surface.vertices.col(v[0]));
    }
  }

  const std::vector<HalfEdge> edges = sorted_half_edges(surface, usable);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t j = i + 1;
    while (j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high) ++j;
    const bool open = j - i == 1;
    const bool crowded = j - i > 2;
    const bool flipped = j - i == 2 && edges[i].forward == edges[i + 1].forward;
    report.open_edges += open;
    report.crowded_edges += crowded;
    report.flipped_edges += flipped;
    if (open || crowded || flipped) {
      defect_at(0.5 * (surface.vertices.col(edges[i].low) + surface.vertices.col(edges[i].high)));
    }
    i = j;
  }
  if (surface.triangle_count() == 0) report.open_edges = 1;
  if (found) report.apart = told_apart(surface.vertices);
  if (report.bad_triangles == 0) report.inside_out = enclosed_volume(surface) < 0.0;
  return report;
}

SurfaceMesh merge_equal_vertices(const SurfaceMesh& surface) {
  std::map<std::array<double, 3>, int> number_of;
  SurfaceMesh merged;
  merged.triangles.resize(3, surface.triangle_count());
  std::vector<Vector3d> kept;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int v = surface.triangles(k, t);
      PALPABLE_EXPECT(v >= 0 && v < surface.vertex_count(), "triangles index existing vertices");
      // + 0.0 turns -0.0 into 0.0, which compares equal but prints and sorts differently.
      const Vector3d x = surface.vertices.col(v).array() + 0.0;
      const auto [at, is_new] =
          number_of.try_emplace({x[0], x[1], x[2]}, static_cast<int>(kept.size()));
      if (is_new) kept.push_back(x);
      merged.triangles(k, t) = at->second;
    }
  }
  merged.vertices.resize(3, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    merged.vertices.col(static_cast<Eigen::Index>(i)) = kept[i];
  }
  return merged;
}

double enclosed_volume(const SurfaceMesh& surface) {
  double six_volumes = 0.0;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const Eigen::Vector3i v = surface.triangles.col(t);
    six_volumes += surface.vertices.col(v[0]).dot(
        surface.vertices.col(v[1]).cross(surface.vertices.col(v[2])));
  }
  return six_volumes / 6.0;
}

Vector3d enclosed_centroid(const SurfaceMesh& surface) {
  double six_volumes = 0.0;
  Vector3d moment =
      Vector3d::Zero();  // sum of 6 V times 4 x centre of each tetrahedron (0, a, b, c)
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const Vector3d a = surface.vertices.col(surface.triangles(0, t));
    const Vector3d b = surface.vertices.col(surface.triangles(1, t));
    const Vector3d c = surface.vertices.col(surface.triangles(2, t));
    const double d = a.dot(b.cross(c));
    six_volumes += d;
    moment += d * (a + b + c);
  }
  PALPABLE_EXPECT(six_volumes != 0.0, "a surface without volume has no centroid");
  return moment / (4.0 * six_volumes);
}

Eigen::AlignedBox3d box_of(const SurfaceMesh& surface) {
  return {surface.vertices.rowwise().minCoeff(), surface.vertices.rowwise().maxCoeff()};
}

Eigen::VectorXd vertex_areas(const SurfaceMesh& surface) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(surface.vertex_count());
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const Eigen::Vector3i v = surface.triangles.col(t);
    const Vector3d a = surface.vertices.col(v[0]);
    const double area =
        0.5 * (surface.vertices.col(v[1]) - a).cross(surface.vertices.col(v[2]) - a).norm();
    for (int k = 0; k < 3; ++k) areas[v[k]] += area / 3.0;
  }
  return areas;
}

namespace {

template <class Number>
void find_vertex_normals(const Eigen::Matrix<Number, 3, Eigen::Dynamic>& vertices,
                         const Eigen::Matrix3Xi& triangles,
                         Eigen::Matrix<Number, 3, Eigen::Dynamic>& normals) {
  PALPABLE_EXPECT(normals.cols() == vertices.cols(), "one normal per vertex");
  normals.setZero();
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const int a = triangles(0, t), b = triangles(1, t), c = triangles(2, t);
    const Eigen::Matrix<Number, 3, 1> n =  // twice the area long, so larger triangles weigh more
        (vertices.col(b) - vertices.col(a)).cross(vertices.col(c) - vertices.col(a));
    normals.col(a) += n;
    normals.col(b) += n;
    normals.col(c) += n;
  }
  for (Eigen::Index i = 0; i < normals.cols(); ++i) {
    const Number length = normals.col(i).norm();
    if (length > 0) normals.col(i) /= length;
  }
}

}  // namespace

void vertex_normals(const Eigen::Matrix3Xf& vertices, const Eigen::Matrix3Xi& triangles,
                    Eigen::Matrix3Xf& normals) {
  find_vertex_normals(vertices, triangles, normals);
}

void vertex_normals(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                    Eigen::Matrix3Xd& normals) {
  find_vertex_normals(vertices, triangles, normals);
}

std::vector<std::vector<int>> vertex_neighbours(const SurfaceMesh& surface) {
  std::vector<std::vector<int>> neighbours(surface.vertex_count());
  for (int t = 0; t < surface.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles(k, t), b = surface.triangles((k + 1) % 3, t);
      neighbours[a].push_back(b);
      neighbours[b].push_back(a);
    }
  }
  for (std::vector<int>& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

std::vector<int> graph_patch(const std::vector<std::vector<int>>& neighbours, int vertex,
                             int graph_distance) {
  PALPABLE_EXPECT(vertex >= 0 && static_cast<std::size_t>(vertex) < neighbours.size(),
                  "the vertex exists");
  std::vector<int> patch{vertex};
  std::vector<bool> reached(neighbours.size(), false);
  reached[vertex] = true;
  std::size_t ring_begin = 0;
  for (int ring = 0; ring < graph_distance; ++ring) {
    const std::size_t ring_end = patch.size();
    std::vector<int> next;
    for (std::size_t i = ring_begin; i < ring_end; ++i) {
      for (const int n : neighbours[patch[i]]) {
        if (reached[n]) continue;
        reached[n] = true;
        next.push_back(n);
      }
    }
    std::sort(next.begin(), next.end());
    patch.insert(patch.end(), next.begin(), next.end());
    ring_begin = ring_end;
  }
  return patch;
}

SurfaceMesh box_surface(const Vector3d& a, const Vector3d& b) {
  SurfaceMesh box;
  box.vertices.resize(3, 8);
  for (int i = 0; i < 8; ++i) {  // bit 0: x, bit 1: y, bit 2: z
    box.vertices.col(i) =
        Vector3d((i & 1) ? b.x() : a.x(), (i & 2) ? b.y() : a.y(), (i & 4) ? b.z() : a.z());
  }
  box.triangles.resize(3, 12);
  box.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,               //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return box;
}

SurfaceMesh sphere_surface(const Vector3d& centre, double radius, int subdivisions) {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  std::vector<Vector3d> v{{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                          {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                          {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<int, 3>> t{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Vector3d& x : v) x.normalize();
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, is_new] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(v.size()));
      if (is_new) { v.push_back((v[a] + v[b]).normalized()); }
      return at->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : t) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    t = std::move(finer);
  }
  SurfaceMesh sphere;
  sphere.vertices.resize(3, static_cast<Eigen::Index>(v.size()));
  for (std::size_t i = 0; i < v.size(); ++i) {
    sphere.vertices.col(static_cast<Eigen::Index>(i)) = centre + radius * v[i];
  }
  sphere.triangles.resize(3, static_cast<Eigen::Index>(t.size()));
  for (std::size_t i = 0; i < t.size(); ++i) {
    sphere.triangles.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3i(t[i][0], t[i][1], t[i][2]);
  }
  return sphere;
}

double mean_edge_length(const SurfaceMesh& surface) {
  PALPABLE_EXPECT(surface.triangle_count() > 0, "a surface has triangles");
  double sum = 0.0;  // each edge of a closed surface is counted twice
  for (const auto& t : surface.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      sum += (surface.vertices.col(t[k]) - surface.vertices.col(t[(k + 1) % 3])).norm();
    }
  }
  return sum / (3.0 * surface.triangle_count());
}

}  // namespace palpable
