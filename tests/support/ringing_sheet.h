/// @file
/// An elastic sheet with mass: each vertex has the same, so that the vibration modes are the
/// eigenvectors of the compliance:
///
///     G = G1 x 1,    G1 v = lambda v,    M = mu 1:    phi = v / sqrt(mu),  omega^2 = 1/(lambda mu)
#pragma once

#include "palpable/common/response/vibration_table.h"
#include "tests/support/elastic_sheet.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <cmath>

namespace palpable::test {

/// @param modes  of each of the three directions, the lowest
/// @param lowest  rad/s, omega of the first one
inline VibrationTable vibration_of(const ElasticSheet& sheet, int modes, double lowest,
                                   double loss_factor) {
  const Eigen::Index V = sheet.skin.vertex_count();
  Eigen::MatrixXd G1(V, V);
  for (Eigen::Index v = 0; v < V; ++v) {
    for (Eigen::Index w = 0; w < V; ++w) G1(v, w) = sheet.G(3 * v, 3 * w);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(G1);
  const double mass = 1 / (eigen.eigenvalues()[V - 1] * lowest * lowest);
  VibrationTable table;
  table.shapes.setZero(3 * modes, 3 * V);
  for (int k = 0; k < modes; ++k) {
    for (int c = 0; c < 3; ++c) {
      table.omega.push_back(1 / std::sqrt(eigen.eigenvalues()[V - 1 - k] * mass));
      const Eigen::VectorXd v = eigen.eigenvectors().col(V - 1 - k) / std::sqrt(mass);
      for (Eigen::Index n = 0; n < V; ++n) {
        table.shapes(3 * k + c, 3 * n + c) = static_cast<float>(v[n]);
      }
    }
  }
  table.loss_factor = loss_factor;
  table.density = 1000;
  table.mass = mass * static_cast<double>(V);
  return table;
}

/// An elastic sheet with that table.
struct RingingSheet : ElasticSheet {
  explicit RingingSheet(double loss_factor = 0.1, int modes = 8, double lowest = 60) {
    tables.vibration = vibration_of(*this, modes, lowest, loss_factor);
  }
};

}  // namespace palpable::test
