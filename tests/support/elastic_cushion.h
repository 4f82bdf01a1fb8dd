/// @file
/// A flat closed body whose compliance is known in closed form, and its tables of touch: what
/// presses its upper side brings its lower side along.
///
///     G_ij = softness exp(-|x_i - x_j| / length) 1
///
/// as elastic_sheet.h has it.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/touch_tables.h"

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <vector>

namespace palpable::test {

class ElasticCushion {
 public:
  static constexpr double kWide = 0.030, kHigh = 0.008;  ///< m, half axes of the ellipsoid
  static constexpr double kSoftness = 0.002;             ///< m/N
  static constexpr double kLength = 0.020;               ///< m

  SurfaceMesh skin;  ///< its middle at the origin
  std::vector<std::uint8_t> fixed;
  TouchTables tables;  ///< linear, all near, without a shell

  ElasticCushion() : skin(sphere_surface(Eigen::Vector3d::Zero(), kWide, 3)) {
    skin.vertices.row(2) *= kHigh / kWide;
    const int V = skin.vertex_count();
    fixed.assign(static_cast<std::size_t>(V), 0);
    tables.point_spacing = 0.0025;
    ComplianceTable& table = tables.compliance;
    table.vertices = V;
    table.clusters = 1;
    table.cluster_of.assign(static_cast<std::size_t>(V), 0);
    table.basis = table.beyond = rounded(RowsOfFloats::Zero(3 * V, 16));
    table.couplings = rounded(RowsOfFloats::Zero(0, 16));
    const std::size_t width = padded(static_cast<std::size_t>(V));
    table.near.assign(9 * width * static_cast<std::size_t>(V), 0);
    for (int v = 0; v < V; ++v) {
      table.first.push_back(V * v);
      table.near_scale.push_back(static_cast<float>(kSoftness / 32767));
      for (int w = 0; w < V; ++w) {
        table.neighbours.push_back(w);
        const auto share =
            static_cast<std::int16_t>(std::lround(32767 * compliance(v, w) / kSoftness));
        for (std::size_t d = 0; d < 3; ++d) {
          table.near[9 * width * static_cast<std::size_t>(v) + 4 * d * width +
                     static_cast<std::size_t>(w)] = share;
        }
      }
    }
    table.first.push_back(V * V);
  }

  /// m/N, in every direction.
  [[nodiscard]] double compliance(int v, int w) const {
    return kSoftness * std::exp(-(skin.vertices.col(v) - skin.vertices.col(w)).norm() / kLength);
  }
};

}  // namespace palpable::test
