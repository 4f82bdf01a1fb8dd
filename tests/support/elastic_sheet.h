/// @file
/// A flat skin whose compliance is known in closed form, and its tables of touch.
///
///     G_ij = softness exp(-|x_i - x_j| / length) 1
///
/// is positive definite whatever the points (Matern's covariance of order 1/2).
#pragma once

#include "palpable/geometry/surface_mesh.h"
#include "palpable/touch/region.h"
#include "palpable/touch/touch_tables.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <cstdint>
#include <vector>

namespace palpable::test {

class ElasticSheet {
 public:
  static constexpr int kSide = 13;            ///< vertices
  static constexpr double kEdge = 0.004;      ///< m between them
  static constexpr double kSoftness = 0.002;  ///< m/N
  static constexpr double kLength = 0.010;    ///< m

  /// In the plane z = 0, its middle vertex at the origin, its upper side to +z.
  SurfaceMesh skin;
  std::vector<std::uint8_t> fixed;
  Eigen::MatrixXd G;  ///< (3V x 3V) m/N
  TouchTables tables;

  /// @param near_radius  m: beyond it the table has its modes alone
  explicit ElasticSheet(double near_radius = 1.0, int rank = 32) {
    const int V = kSide * kSide;
    skin.vertices.resize(3, V);
    for (int v = 0; v < V; ++v) {
      skin.vertices.col(v) << kEdge * (v % kSide - kSide / 2), kEdge * (v / kSide - kSide / 2), 0.0;
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
    tables.point_spacing = kEdge;  // the vertices alone
  }

  [[nodiscard]] int middle() const { return kSide * kSide / 2; }

 private:
  void make_compliance(double near_radius, int rank) {
    using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    ComplianceTable& table = tables.compliance;
    const int V = skin.vertex_count();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(G);
    const Eigen::MatrixXd Phi = eigen.eigenvectors().rightCols(rank);
    const RoundedRows modes = rounded(Rows(Phi.cast<float>()));
    const RoundedRows codes = rounded(Rows((G * Phi).cast<float>()));
    table.vertices = V;
    table.rank = rank;
    table.modes = modes.values;
    table.mode_scale = modes.scale;
    table.codes = codes.values;
    table.code_scale = codes.scale;
    const Eigen::MatrixXd rest = G - Phi * (G * Phi).transpose();
    table.first.push_back(0);
    for (int v = 0; v < V; ++v) {
      std::vector<int> near;
      for (int w = 0; w < V; ++w) {
        if ((skin.vertices.col(v) - skin.vertices.col(w)).norm() <= near_radius) near.push_back(w);
      }
      const std::size_t width = padded(near.size()), at = table.near.size();
      table.near.resize(at + 9 * width, 0);
      const double scale = rest.middleCols(3 * v, 3).cwiseAbs().maxCoeff() / 32767.0;
      table.near_scale.push_back(static_cast<float>(scale));
      for (std::size_t k = 0; k < near.size(); ++k) {
        for (int d = 0; d < 3; ++d) {
          for (int c = 0; c < 3; ++c) {
            table.near[at + static_cast<std::size_t>(3 * d + c) * width + k] =
                static_cast<std::int16_t>(std::lround(rest(3 * near[k] + c, 3 * v + d) / scale));
          }
        }
      }
      table.neighbours.insert(table.neighbours.end(), near.begin(), near.end());
      table.first.push_back(static_cast<int>(table.neighbours.size()));
    }
  }
};

}  // namespace palpable::test
