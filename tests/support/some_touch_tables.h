/// @file
/// Tables of touch of any skin whose numbers mean nothing, but all fit together: for files.
#pragma once

#include "palpable/geometry/surface_mesh.h"
#include "palpable/touch/touch_tables.h"

#include <Eigen/Core>

#include <algorithm>
#include <random>
#include <vector>

namespace palpable::test {

namespace some_tables {

inline RoundedRows rows(std::mt19937& random, int count, int width, float size) {
  std::uniform_real_distribution<float> value(-size, size);
  return rounded(RowsOfFloats::NullaryExpr(count, width, [&] { return value(random); }));
}

inline SymmetricForm form(std::mt19937& random, int variables, int degree) {
  std::uniform_real_distribution<double> value(-1e-3, 1e-3);
  std::vector<double> coefficients(distinct_coefficients(variables, degree));
  for (double& c : coefficients) c = value(random);
  return rounded(variables, degree, coefficients);
}

// Three slices of the skin, one above the other; only the lowest and the highest are far apart.
inline bool are_far(int c, int d) { return c + d == 2 && c != d; }

inline std::vector<int> vertices_near(const ComplianceTable& table, int cluster) {
  std::vector<int> found;
  for (int v = 0; v < table.vertices; ++v) {
    if (!are_far(cluster, table.cluster_of[static_cast<std::size_t>(v)])) found.push_back(v);
  }
  return found;
}

inline ComplianceTable compliance(std::mt19937& random, const SurfaceMesh& skin, int rank) {
  ComplianceTable c;
  const int V = c.vertices = skin.vertex_count();
  c.clusters = 3;
  const double low = skin.vertices.row(2).minCoeff();
  const double height = skin.vertices.row(2).maxCoeff() - low;
  for (int v = 0; v < V; ++v) {
    c.cluster_of.push_back(std::min(2, static_cast<int>(3 * (skin.vertices(2, v) - low) / height)));
  }
  c.basis = rows(random, 3 * V, rank, 0.1f);
  c.far_first = {0};
  c.far_second = {2};
  c.couplings = rows(random, rank, rank, 1e-4f);
  c.first.push_back(0);
  for (int v = 0; v < V; ++v) {
    const std::vector<int> near = vertices_near(c, c.cluster_of[static_cast<std::size_t>(v)]);
    const std::size_t width = padded(near.size()), at = c.near.size();
    c.near.resize(at + 9 * width, 0);
    for (std::size_t k = 0; k < near.size(); ++k) {
      for (std::size_t d = 0; near[k] == v && d < 3; ++d) c.near[at + 4 * d * width + k] = 1000;
    }
    c.near_scale.push_back(1e-6f);
    c.neighbours.insert(c.neighbours.end(), near.begin(), near.end());
    c.first.push_back(static_cast<int>(c.neighbours.size()));
  }
  return c;
}

}  // namespace some_tables

/// 1 mm/N at each vertex itself and 32 directions of each of three clusters; `regions` of 16 modes,
/// 5 of them leading, and 48 cross modes where there are regions.
inline TouchTables some_touch_tables(const SurfaceMesh& skin, int regions = 3) {
  constexpr int kRank = 32, kModes = 16, kLeading = 5, kCrossModes = 48;
  std::mt19937 random(5);
  TouchTables tables;
  tables.point_spacing = 0.011;
  tables.region_reach = 0.021;
  const int V = skin.vertex_count();
  tables.compliance = some_tables::compliance(random, skin, kRank);
  for (int k = 0; k < regions; ++k) {
    RegionTable region;
    region.vertex = (7 * k + 1) % V;
    const int cluster = tables.compliance.cluster_of[static_cast<std::size_t>(region.vertex)];
    region.vertices = some_tables::vertices_near(tables.compliance, cluster);
    region.modes =
        some_tables::rows(random, 3 * static_cast<int>(region.vertices.size()), kModes, 0.03f);
    region.source_clusters = {cluster};
    region.sources = some_tables::rows(random, kModes, kRank, 0.2f);
    region.cubic = some_tables::form(random, kModes, 3);
    region.quartic = some_tables::form(random, kLeading, 4);
    tables.regions.push_back(std::move(region));
  }
  if (regions > 0) {
    tables.cross.modes = some_tables::rows(random, 3 * V, kCrossModes, 0.01f);
    tables.cross.cubic = some_tables::form(random, kCrossModes, 3);
  }
  return tables;
}

}  // namespace palpable::test
