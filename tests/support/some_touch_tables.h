/// @file
/// Tables of touch of any skin whose numbers mean nothing, but all fit together: for files.
#pragma once

#include "palpable/geometry/surface_mesh.h"
#include "palpable/touch/touch_tables.h"

#include <Eigen/Core>

#include <random>
#include <vector>

namespace palpable::test {

namespace some_tables {

using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline RoundedRows rows(std::mt19937& random, int count, int width, float size) {
  std::uniform_real_distribution<float> value(-size, size);
  return rounded(Rows::NullaryExpr(count, width, [&] { return value(random); }));
}

inline SymmetricForm form(std::mt19937& random, int variables, int degree) {
  std::uniform_real_distribution<double> value(-1e-3, 1e-3);
  std::vector<double> coefficients(distinct_coefficients(variables, degree));
  for (double& c : coefficients) c = value(random);
  return rounded(variables, degree, coefficients);
}

inline std::vector<int> near(const SurfaceMesh& skin, int vertex, double radius) {
  std::vector<int> found;
  for (int v = 0; v < skin.vertex_count(); ++v) {
    if ((skin.vertices.col(v) - skin.vertices.col(vertex)).norm() <= radius) found.push_back(v);
  }
  return found;
}

}  // namespace some_tables

/// 32 modes and 1 mm/N at each vertex itself; `regions` of 16 modes, 5 leading ones, and 10 cross
/// modes where there are regions.
inline TouchTables some_touch_tables(const SurfaceMesh& skin, int regions = 3) {
  constexpr int kRank = 32, kModes = 16, kLeading = 5, kCrossModes = 10;
  std::mt19937 random(5);
  TouchTables tables;
  tables.point_spacing = 0.011;
  tables.region_reach = 0.021;
  const int V = skin.vertex_count();
  ComplianceTable& c = tables.compliance;
  c.vertices = V;
  c.rank = kRank;
  const RoundedRows modes = some_tables::rows(random, 3 * V, kRank, 0.1f);
  c.modes = c.codes = modes.values;
  c.mode_scale = modes.scale;
  for (const float scale : modes.scale) c.code_scale.push_back(1e-3f * scale);
  c.first.push_back(0);
  for (int v = 0; v < V; ++v) {
    const std::vector<int> near = some_tables::near(skin, v, 0.03);
    const std::size_t width = padded(near.size()), at = c.near.size();
    c.near.resize(at + 9 * width, 0);
    for (std::size_t k = 0; k < near.size(); ++k) {
      for (std::size_t d = 0; near[k] == v && d < 3; ++d) c.near[at + 4 * d * width + k] = 1000;
    }
    c.near_scale.push_back(1e-6f);
    c.neighbours.insert(c.neighbours.end(), near.begin(), near.end());
    c.first.push_back(static_cast<int>(c.neighbours.size()));
  }
  for (int k = 0; k < regions; ++k) {
    RegionTable region;
    region.vertex = (7 * k + 1) % V;
    region.vertices = some_tables::near(skin, region.vertex, 0.04);
    region.modes =
        some_tables::rows(random, 3 * static_cast<int>(region.vertices.size()), kModes, 0.03f);
    region.from_compliance = some_tables::rows(random, kModes, kRank, 0.2f);
    region.cubic = some_tables::form(random, kModes, 3);
    region.quartic = some_tables::form(random, kLeading, 4);
    tables.regions.push_back(std::move(region));
  }
  if (regions > 0) {
    tables.cross.from_compliance = some_tables::rows(random, kCrossModes, kRank, 0.1f);
    tables.cross.cubic = some_tables::form(random, kCrossModes, 3);
  }
  return tables;
}

}  // namespace palpable::test
