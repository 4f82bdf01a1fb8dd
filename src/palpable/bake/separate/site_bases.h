/// @file
/// A POD of PODs: represents the snapshots of each sample of the first parameter (each site) in a
/// basis of their own, and computes the Gram matrix of all snapshots from these bases. Shapes:
/// snapshot_tensor.h; R is the number of columns of all bases together.
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"

#include <cstddef>
#include <vector>

namespace palpable {

/// Presses on one site span few dimensions (6 for 26 levels at a tolerance of 1e-5), so that
/// products of all snapshots cost a tenth: through R = 34 * 8 columns instead of K = 34 * 26.
struct SiteBases {
  Eigen::Index N = 0;
  std::vector<double> columns;     ///< (N x R) the bases Q_s, orthonormal, one after the other
  std::vector<Eigen::MatrixXd> C;  ///< (n_1) of (R_s x n): W^1/2 A_s ~= Q_s C_s
  Eigen::MatrixXd gram;            ///< (K x K) lower triangle of A^T W A; exact within a site

  /// (N x m) W^-1/2 Q C combination. @param combination  (K x m)
  [[nodiscard]] Eigen::MatrixXd combine(const Eigen::MatrixXd& combination,
                                        const Eigen::VectorXd& weights) const;
};

/// Reads each site's snapshots once.
/// @param lose  relative error that a site's basis may have: the root mean square over the site's
///              snapshots, each relative to its own norm
/// @throws Error if values are not finite
[[nodiscard]] SiteBases site_bases(const SnapshotRows& snapshots, const Eigen::VectorXd& weights,
                                   double lose);

}  // namespace palpable
