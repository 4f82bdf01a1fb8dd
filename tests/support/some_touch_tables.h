/// @file
/// Consistent tables of touch with arbitrary numbers, for any skin that is star-shaped around its
/// centre: for tests of files.
#pragma once

#include "palpable/common/base/row_kernels.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/touch_tables.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
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

// Three slices of the skin, one above the other; only the lowest and the highest are far
// from each other.
inline bool are_far(int c, int d) { return c + d == 2 && c != d; }

inline std::vector<int> nodes_near(const ComplianceTable& table, int cluster) {
  std::vector<int> found;
  for (int v = 0; v < table.nodes(); ++v) {
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
  c.cluster_of.push_back(1);  // of the inner node
  c.basis = rows(random, 3 * (V + 1), rank, 0.1f);
  c.beyond = rows(random, 3 * (V + 1), rank, 0.1f);
  c.far_first = {0};
  c.far_second = {2};
  c.couplings = rows(random, rank, rank, 1e-4f);
  c.first.push_back(0);
  for (int v = 0; v < V; ++v) {
    const std::vector<int> near = nodes_near(c, c.cluster_of[static_cast<std::size_t>(v)]);
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

// A tetrahedron from each triangle to one inner node, of two materials alternately. Stress at a
// vertex is the mean over the tetrahedra that contain it.
inline ShellTable shell(const SurfaceMesh& skin) {
  ShellTable s;
  const int V = skin.vertex_count();
  s.stress_free.resize(3, V + 1);
  s.stress_free << skin.vertices, skin.vertices.rowwise().mean();
  s.preload = 1e-6 * s.stress_free;
  s.materials = {material_from_young("neo-hookean", 60e3, 0.4),
                 material_from_young("mooney-rivlin", 40e3, 0.3)};
  std::vector<std::vector<int>> around(static_cast<std::size_t>(V));
  for (int t = 0; t < skin.triangle_count(); ++t) {
    s.elements.push_back(V);
    for (const int v : skin.triangles.col(t)) {
      s.elements.push_back(v);
      around[static_cast<std::size_t>(v)].push_back(t);
    }
    s.material_of.push_back(t % 2);
  }
  s.first.push_back(0);
  for (const std::vector<int>& triangles : around) {
    s.points.insert(s.points.end(), triangles.begin(), triangles.end());
    s.weights.insert(s.weights.end(), triangles.size(),
                     1.0f / static_cast<float>(triangles.size()));
    s.first.push_back(static_cast<int>(s.points.size()));
  }
  return s;
}

}  // namespace some_tables

/// A compliance of 1 mm/N at each vertex itself, and a rank of 32 for each of three clusters;
/// `regions` of 16 modes, 5 of them leading, with 32 far shapes; if there are regions, 48 cross
/// modes and two held-out touches; a shell with one inner node.
inline TouchTables some_touch_tables(const SurfaceMesh& skin, int regions = 3) {
  constexpr int kRank = 32, kModes = 16, kLeading = 5, kFarShapes = 32, kCrossModes = 48;
  std::mt19937 random(5);
  TouchTables tables;
  tables.point_spacing = 0.011;
  tables.region_reach = 0.021;
  const int V = skin.vertex_count();
  tables.compliance = some_tables::compliance(random, skin, kRank);
  tables.shell = some_tables::shell(skin);
  for (int k = 0; k < regions; ++k) {
    RegionTable region;
    region.vertex = (7 * k + 1) % V;
    const int cluster = tables.compliance.cluster_of[static_cast<std::size_t>(region.vertex)];
    region.vertices = some_tables::nodes_near(tables.compliance, cluster);
    region.modes =
        some_tables::rows(random, 3 * static_cast<int>(region.vertices.size()), kModes, 0.03f);
    const int far = cluster == 1 ? 0 : 1;  // index of the other cluster
    region.far_shapes = some_tables::rows(random, far * kRank, kFarShapes, 0.02f);
    region.far_shares = some_tables::rows(random, kFarShapes, kModes, 0.2f);
    region.cubic = some_tables::form(random, kModes, 3);
    region.quartic = some_tables::form(random, kLeading, 4);
    tables.regions.push_back(std::move(region));
  }
  if (regions > 0) {
    tables.cross.modes = some_tables::rows(random, 3 * (V + 1), kCrossModes, 0.01f);
    tables.cross.cubic = some_tables::form(random, kCrossModes, 3);
    tables.held_out = {{PressingThing::kFinger, 0.002, 0.01, 0.02, 0.03, 0.015},
                       {PressingThing::kRim, 0.005, 0.04, 0.05, 0.06, 0.025}};
  }
  return tables;
}

/// Vibration modes with arbitrary shapes, for a shell of this number of nodes.
inline VibrationTable some_vibration(int nodes, int modes = 5) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> value(-2, 2);
  VibrationTable table;
  for (int k = 0; k < modes; ++k) table.omega.push_back(30.0 + 7.5 * k);
  table.shapes = Eigen::MatrixXf::NullaryExpr(modes, 3 * nodes, [&] { return value(random); });
  table.loss_factor = 0.15;
  table.density = 1070;
  table.mass = 0.4;
  return table;
}

/// Tables without regions of a skin with the compliance
///
///      G_vw = 1 mm/N exp(-|x_v - x_w| / 20 mm)
///
/// so that a press also displaces the neighbourhood.
inline TouchTables yielding_tables(const SurfaceMesh& skin) {
  TouchTables tables = some_touch_tables(skin, 0);
  ComplianceTable& table = tables.compliance;
  const Eigen::Matrix3Xd& x = skin.vertices;
  std::size_t at = 0;
  for (int v = 0; v < table.vertices; ++v) {
    const auto first = static_cast<std::size_t>(table.first[v]);
    const std::size_t count = static_cast<std::size_t>(table.first[v + 1]) - first;
    table.near_scale[v] = 1e-3f / 32767;
    for (std::size_t k = 0; k < count; ++k) {
      const int w = table.neighbours[first + k];
      if (w >= table.vertices) continue;  // an inner node, which does not move
      const double share = std::exp(-(x.col(v) - x.col(w)).norm() / 0.020);
      for (std::size_t d = 0; d < 3; ++d) {
        table.near[at + 4 * d * padded(count) + k] =
            static_cast<std::int16_t>(std::lround(32767 * share));
      }
    }
    at += 9 * padded(count);
  }
  return tables;
}

/// Adds a region that holds all vertices, with arbitrary modes. @param size  sqrt(m/N), of the
/// modes
inline void add_region_all_over(TouchTables& tables, float size) {
  constexpr int kModes = 16, kLeading = 5, kFarShapes = 32;
  std::mt19937 random(7);
  RegionTable region;
  const int V = tables.compliance.vertices;
  region.vertices.resize(static_cast<std::size_t>(V));
  std::iota(region.vertices.begin(), region.vertices.end(), 0);
  region.modes = some_tables::rows(random, 3 * V, kModes, size);
  region.far_shapes = some_tables::rows(random, 0, kFarShapes, 0.02f);
  region.far_shares = some_tables::rows(random, kFarShapes, kModes, 0.2f);
  region.cubic = some_tables::form(random, kModes, 3);
  region.quartic = some_tables::form(random, kLeading, 4);
  tables.regions.push_back(std::move(region));
  tables.region_reach = 0.1;
}

/// Three modes, in each of which all nodes move alike along an axis, at 10 Hz. They are modes of a
/// skin with yielding_tables(): their part of its compliance, 0.05 mm/N, leaves the rest positive.
inline VibrationTable swinging_vibration(int nodes) {
  VibrationTable table;
  table.omega.assign(3, 62.8);
  table.shapes.setZero(3, 3 * nodes);
  const auto shape = static_cast<float>(62.8 * std::sqrt(5e-5));
  for (int n = 0; n < nodes; ++n) {
    for (int c = 0; c < 3; ++c) table.shapes(c, 3 * n + c) = shape;
  }
  table.loss_factor = 0.2;
  table.density = 1000;
  table.mass = 5;
  return table;
}

}  // namespace palpable::test
