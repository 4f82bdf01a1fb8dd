/// @file
/// The snapshots in the coordinates of their own POD basis, where every method is two hundred times
/// cheaper and finds the same modes. Shapes: snapshot_tensor.h; r coordinates, r <= K.
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"

#include <vector>

namespace palpable {

/// (K x K) lower triangle of A^T W A, read in one pass. @throws Error if values are not finite
[[nodiscard]] Eigen::MatrixXd gram_of(const SnapshotRows& snapshots,
                                      const Eigen::VectorXd& weights);

/// A D^-1 = Q C with Q orthonormal in the weighted norm, D the scale of each snapshot.
struct PodCoordinates {
  Eigen::MatrixXd C;            ///< (r x K), rows orthogonal, by size
  Eigen::MatrixXd combination;  ///< (K x r) Q = A combination
  double lost = 0;              ///< relative norm of what the r coordinates leave out
};

/// From the eigenvectors of the Gram matrix: D^-1 A^T W A D^-1 = V S^2 V^T gives C = S V^T and
/// Q = A D^-1 V S^-1 ("method of snapshots", Sirovich 1987). It squares the condition: parts below
/// 1e-7 of the largest are lost, whatever `lose` says.
/// @param gram   (K x K) lower triangle
/// @param scale  (K) D, > 0
/// @param lose   how much may be left out, relative
/// @throws Error if the snapshots are all zero
[[nodiscard]] PodCoordinates pod_coordinates(const Eigen::MatrixXd& gram,
                                             const Eigen::VectorXd& scale, double lose);

/// (p) of (n_j): factors d^j > 0 whose products are nearest to the norms, in the mean of squares of
/// logarithms; exact for p = 1. Norms of zero count as 1. Dividing a tensor by them weights each
/// snapshot by its own norm and leaves it a tensor whose modes are separated.
[[nodiscard]] std::vector<Eigen::VectorXd> separated_norms(const Eigen::VectorXd& norms,
                                                           const std::vector<int>& sizes);

}  // namespace palpable
