/// @file
/// A flat closed body whose compliance is known in closed form, and its tables of touch. A press on
/// the upper side also displaces the lower side.
///
///     G_ij = softness exp(-|x_i - x_j| / length) 1
///
/// as in elastic_sheet.h; or the part of G in its leading eigenvectors, from which a body in modes
/// can also be made.
#pragma once

#include "palpable/common/base/row_kernels.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/touch_tables.h"
#include "tests/support/bodies.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <cstdint>
#include <vector>

namespace palpable::test {

class ElasticCushion {
 public:
  static constexpr double kWide = 0.030, kHigh = 0.008;  ///< m, half axes of the ellipsoid
  static constexpr double kSoftness = 0.002;             ///< m/N
  static constexpr double kLength = 0.020;               ///< m

  SurfaceMesh skin;  ///< centred at the origin
  std::vector<std::uint8_t> fixed;
  TouchTables tables;  ///< linear, all near, without a shell

  /// @param leading  number of eigenvectors of the compliance to keep; 0: all
  explicit ElasticCushion(int leading = 0)
      : skin(sphere_surface(Eigen::Vector3d::Zero(), kWide, 3)) {
    skin.vertices.row(2) *= kHigh / kWide;
    const int V = skin.vertex_count();
    fixed.assign(static_cast<std::size_t>(V), 0);
    compliance_ = Eigen::MatrixXd::NullaryExpr(V, V, [&](Eigen::Index v, Eigen::Index w) {
      return kSoftness * std::exp(-(skin.vertices.col(v) - skin.vertices.col(w)).norm() / kLength);
    });
    if (leading > 0) keep_leading(leading);
    make_tables();
  }

  /// m/N, the same in every direction.
  [[nodiscard]] double compliance(int v, int w) const { return compliance_(v, w); }

  /// The same body by its energy 1/2 q . q, with three modes for each eigenvector; without a shell.
  /// @pre leading > 0
  [[nodiscard]] ReducedBody in_modes() const {
    ReducedBody body = pressed_ball();  // contact does not read its fields
    body.surface = skin;
    body.fixed = fixed;
    const Eigen::Index k = eigenvectors_.cols(), n = 3 * k, pairs = n * (n + 1) / 2;
    SeveralLoads several;
    several.energy = {Eigen::VectorXd::Zero(pairs), Eigen::MatrixXd::Zero(pairs, n),
                      Eigen::MatrixXd::Zero(pairs, pairs)};
    several.modes = Eigen::MatrixXf::Zero(3 * eigenvectors_.rows(), n);
    for (Eigen::Index i = 0; i < n; ++i) {
      several.energy.K[pair_row(i, i)] = 1;
      for (Eigen::Index v = 0; v < eigenvectors_.rows(); ++v) {
        several.modes(3 * v + i % 3, i) = static_cast<float>(eigenvectors_(v, i / 3));
      }
    }
    body.several = several;
    return body;
  }

 private:
  // Reduces the compliance to its leading eigenvectors. eigenvectors_ is scaled by the square roots
  // of the eigenvalues.
  void keep_leading(int count) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(compliance_);
    eigenvectors_ = solver.eigenvectors().rightCols(count) *
                    solver.eigenvalues().tail(count).cwiseSqrt().asDiagonal();
    compliance_ = eigenvectors_ * eigenvectors_.transpose();
  }
  void make_tables() {
    const int V = skin.vertex_count();
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

  Eigen::MatrixXd compliance_, eigenvectors_;  // (V x V) m/N, (V x k) sqrt(m/N)
};

}  // namespace palpable::test
