#include "palpable/common/geometry/vertex_weld.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;

constexpr double kOfMeanEdge = 1e-4, kOfShortestEdge = 0.1;

// (N) how near a vertex must be to be joined; 0: not at all.
std::vector<double> tolerances_of(const SurfaceMesh& surface) {
  const auto n = static_cast<std::size_t>(surface.vertex_count());
  std::vector<double> sum(n, 0.0), shortest(n, std::numeric_limits<double>::infinity());
  std::vector<int> count(n, 0);
  for (const auto& t : surface.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      const double length = (surface.vertices.col(a) - surface.vertices.col(b)).norm();
      if (!(length > 0.0)) continue;
      for (const int v : {a, b}) {
        sum[v] += length;
        ++count[v];
        shortest[v] = std::min(shortest[v], length);
      }
    }
  }
  std::vector<double> tolerances(n, 0.0);
  for (std::size_t v = 0; v < n; ++v) {
    if (count[v] == 0) continue;
    tolerances[v] = std::min(kOfMeanEdge * sum[v] / count[v], kOfShortestEdge * shortest[v]);
    if (!std::isfinite(tolerances[v])) tolerances[v] = 0.0;
  }
  return tolerances;
}

// Whether each vertex lies on an edge of a single triangle.
std::vector<char> open_vertices(const SurfaceMesh& surface) {
  std::vector<std::pair<int, int>> edges;
  for (const auto& t : surface.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      edges.emplace_back(std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3]));
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<char> open(static_cast<std::size_t>(surface.vertex_count()), 0);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t j = i;
    while (j < edges.size() && edges[j] == edges[i]) ++j;
    if (j - i == 1) open[edges[i].first] = open[edges[i].second] = 1;
    i = j;
  }
  return open;
}

// The vertices that stay, in grids of cells: one grid for the tolerances of each power of two.
// Those of a grid are at least a quarter of a cell apart where they are open, so a cell holds few
// of them, whatever the lengths of the surface's edges.
class StayingVertices {
 public:
  StayingVertices(const SurfaceMesh& surface, const std::vector<double>& tolerances,
                  const std::vector<char>& open)
      : surface_(surface), tolerances_(tolerances), open_(open) {}

  // The nearest vertex to join `vertex` with, and its distance; -1: none.
  [[nodiscard]] std::pair<int, double> find(int vertex) const {
    std::pair<int, double> nearest{-1, std::numeric_limits<double>::infinity()};
    for (const auto& [level, grid] : grids_) {
      if (!is_countable(vertex, level)) continue;
      // A tolerance is less than half a cell: the nearer neighbour along each axis is enough.
      const Cell first = cell_of(vertex, level, 0.5);
      for (int at = 0; at < 8; ++at) {
        const auto here =
            grid.find({first[0] + (at & 1), first[1] + (at >> 1 & 1), first[2] + (at >> 2)});
        if (here == grid.end()) continue;
        for (const int other : here->second) consider(vertex, other, nearest);
      }
    }
    return nearest;
  }

  void add(int vertex) {
    const int level = std::ilogb(tolerances_[vertex]) + 2;
    if (is_countable(vertex, level)) grids_[level][cell_of(vertex, level, 0.0)].push_back(vertex);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const {
      std::uint64_t hash = 0;
      for (const std::int64_t k : cell) {
        hash = (hash ^ static_cast<std::uint64_t>(k)) * 0x9E3779B97F4A7C15u;
        hash ^= hash >> 29;
      }
      return hash;
    }
  };

  void consider(int vertex, int other, std::pair<int, double>& nearest) const {
    if (open_[vertex] == 0 && open_[other] == 0) return;
    const double away = (surface_.vertices.col(vertex) - surface_.vertices.col(other)).norm();
    if (away < std::min(tolerances_[vertex], tolerances_[other]) && away < nearest.second) {
      nearest = {other, away};
    }
  }

  // Whether cells can be numbered that far from the origin; where they cannot, a double does not
  // tell neighbours apart.
  [[nodiscard]] bool is_countable(int vertex, int level) const {
    return std::ldexp(surface_.vertices.col(vertex).cwiseAbs().maxCoeff(), -level) < 1e15;
  }

  // The cell, of size 2^level, that is `shift` cells below the vertex along each axis.
  [[nodiscard]] Cell cell_of(int vertex, int level, double shift) const {
    Cell cell{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = surface_.vertices(static_cast<Eigen::Index>(k), vertex);
      cell[k] = static_cast<std::int64_t>(std::floor(std::ldexp(x, -level) - shift));
    }
    return cell;
  }

  const SurfaceMesh& surface_;
  const std::vector<double>& tolerances_;
  const std::vector<char>& open_;
  std::map<int, std::unordered_map<Cell, std::vector<int>, CellHash>> grids_;
};

}  // namespace

VertexWeld weld_open_vertices(SurfaceMesh& surface) {
  const std::vector<double> tolerances = tolerances_of(surface);
  const std::vector<char> open = open_vertices(surface);
  StayingVertices staying(surface, tolerances, open);
  VertexWeld weld;
  std::vector<int> joined(static_cast<std::size_t>(surface.vertex_count()));
  for (int v = 0; v < surface.vertex_count(); ++v) {
    joined[v] = v;
    if (!(tolerances[v] > 0.0)) continue;
    const auto [other, away] = staying.find(v);
    if (other < 0) {
      staying.add(v);
      continue;
    }
    joined[v] = other;
    ++weld.welded;
    weld.moved = std::max(weld.moved, away);
  }
  if (weld.welded == 0) return weld;
  for (int& v : surface.triangles.reshaped()) v = joined[v];
  surface = merge_equal_vertices(surface);
  return weld;
}

}  // namespace palpable
