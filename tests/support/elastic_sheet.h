/// @file
/// A flat skin whose compliance is known in closed form, and its tables of touch.
///
///     G_ij = softness exp(-|x_i - x_j| / length) 1
///
/// is positive definite for any set of points (Matern's covariance of order 1/2).
#pragma once

#include "palpable/common/base/row_kernels.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/touch_tables.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace palpable::test {

class ElasticSheet {
 public:
  static constexpr int kSide = 13;            ///< vertices
  static constexpr double kEdge = 0.004;      ///< m, between vertices
  static constexpr double kSoftness = 0.002;  ///< m/N
  static constexpr double kLength = 0.010;    ///< m

  /// In the plane z = 0, its central vertex at the origin, its upper side towards +z.
  SurfaceMesh skin;
  std::vector<std::uint8_t> fixed;
  Eigen::MatrixXd G;  ///< (3V x 3V) m/N
  TouchTables tables;

  /// @param near_radius  m; clusters whose centres are farther apart are far from each other
  /// @param rank         k
  explicit ElasticSheet(double near_radius = 1.0, int rank = 48) {
    const int V = kSide * kSide;
    skin.vertices.resize(3, V);
    for (int v = 0; v < V; ++v) {
      const int column = v % kSide - kSide / 2;
      const int row = v / kSide - kSide / 2;
      skin.vertices.col(v) << kEdge * column, kEdge * row, 0.0;
    }
    skin.triangles.resize(3, 2 * (kSide - 1) * (kSide - 1));
    int t = 0;
    for (int y = 0; y + 1 < kSide; ++y) {
      for (int x = 0; x + 1 < kSide; ++x) {
        const int v = y * kSide + x;
        skin.triangles.col(t++) << v, v + 1, v + kSide + 1;
        skin.triangles.col(t++) << v, v + kSide + 1, v + kSide;
      }
    }
    fixed.assign(static_cast<std::size_t>(V), 0);
    G = Eigen::MatrixXd::Zero(3 * V, 3 * V);
    for (int v = 0; v < V; ++v) {
      for (int w = 0; w < V; ++w) {
        const double d = (skin.vertices.col(v) - skin.vertices.col(w)).norm();
        for (int c = 0; c < 3; ++c) {
          G(3 * v + c, 3 * w + c) = kSoftness * std::exp(-d / kLength);
        }
      }
    }
    make_compliance(near_radius, rank);
    tables.point_spacing = kEdge;  // only the vertices
  }

  [[nodiscard]] int middle() const { return kSide * kSide / 2; }

 private:
  static constexpr int kTile = 4;  // vertices of a cluster in each direction

  void make_compliance(double near_radius, int rank) {
    ComplianceTable& table = tables.compliance;
    const int V = skin.vertex_count(), tiles = (kSide + kTile - 1) / kTile, C = tiles * tiles;
    table.vertices = V;
    table.clusters = C;
    std::vector<std::vector<int>> members(static_cast<std::size_t>(C));
    for (int v = 0; v < V; ++v) {
      const int c = v / kSide / kTile * tiles + v % kSide / kTile;
      table.cluster_of.push_back(c);
      members[static_cast<std::size_t>(c)].push_back(v);
    }
    const auto far = [&](int c, int d) {
      const auto place = [&](int k) -> Eigen::Vector2d {
        return kTile * kEdge * Eigen::Vector2d(k % tiles, k / tiles);
      };
      return (place(c) - place(d)).norm() > near_radius;
    };
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(3 * V, rank);
    for (int c = 0; c < C; ++c) {
      const Eigen::MatrixXd here = rows_of(G, members[static_cast<std::size_t>(c)]);
      Eigen::MatrixXd from_afar = here;
      for (int v = 0; v < V; ++v) {
        if (!far(c, table.cluster_of[static_cast<std::size_t>(v)])) {
          from_afar.middleCols(3 * v, 3).setZero();
        }
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(from_afar * from_afar.transpose());
      const Eigen::Index kept = std::min<Eigen::Index>(rank, here.rows());
      for (std::size_t k = 0; k < members[static_cast<std::size_t>(c)].size(); ++k) {
        P.block(3 * members[static_cast<std::size_t>(c)][k], 0, 3, kept) =
            eigen.eigenvectors().rightCols(kept).middleRows(3 * static_cast<Eigen::Index>(k), 3);
      }
    }
    table.basis = rounded(P.cast<float>());
    table.beyond = table.basis;
    P = as_numbers(table.basis);
    std::vector<Eigen::MatrixXd> couplings;
    for (int c = 0; c < C; ++c) {
      for (int d = c + 1; d < C; ++d) {
        if (!far(c, d)) continue;
        table.far_first.push_back(c);
        table.far_second.push_back(d);
        const auto &here = members[static_cast<std::size_t>(c)],
                   &there = members[static_cast<std::size_t>(d)];
        const Eigen::MatrixXd block = rows_of(rows_of(G, here).transpose(), there);
        couplings.emplace_back(rows_of(P, here).transpose() * block.transpose() *
                               rows_of(P, there));
      }
    }
    RowsOfFloats all(rank * static_cast<Eigen::Index>(couplings.size()), rank);
    for (std::size_t k = 0; k < couplings.size(); ++k) {
      all.middleRows(rank * static_cast<Eigen::Index>(k), rank) = couplings[k].cast<float>();
    }
    table.couplings = rounded(all);
    make_near(far);
  }

  // The rows of the given vertices.
  [[nodiscard]] static Eigen::MatrixXd rows_of(const Eigen::MatrixXd& all,
                                               const std::vector<int>& vertices) {
    Eigen::MatrixXd rows(3 * static_cast<Eigen::Index>(vertices.size()), all.cols());
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      rows.middleRows(3 * static_cast<Eigen::Index>(k), 3) = all.middleRows(3 * vertices[k], 3);
    }
    return rows;
  }

  void make_near(const auto& far) {
    ComplianceTable& table = tables.compliance;
    const int V = skin.vertex_count();
    table.first.push_back(0);
    for (int v = 0; v < V; ++v) {
      std::vector<int> near;
      for (int w = 0; w < V; ++w) {
        if (!far(table.cluster_of[static_cast<std::size_t>(v)],
                 table.cluster_of[static_cast<std::size_t>(w)])) {
          near.push_back(w);
        }
      }
      const std::size_t width = padded(near.size()), at = table.near.size();
      table.near.resize(at + 9 * width, 0);
      const double scale = kSoftness / 32767.0;  // the largest entry of G is kSoftness
      table.near_scale.push_back(static_cast<float>(scale));
      for (std::size_t k = 0; k < near.size(); ++k) {
        for (int d = 0; d < 3; ++d) {
          for (int c = 0; c < 3; ++c) {
            table.near[at + static_cast<std::size_t>(3 * d + c) * width + k] =
                static_cast<std::int16_t>(std::lround(G(3 * near[k] + c, 3 * v + d) / scale));
          }
        }
      }
      table.neighbours.insert(table.neighbours.end(), near.begin(), near.end());
      table.first.push_back(static_cast<int>(table.neighbours.size()));
    }
  }
};

}  // namespace palpable::test
