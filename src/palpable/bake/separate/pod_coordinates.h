/// @file
/// Snapshots in the coordinates of their own POD basis. There every method finds the same modes at
/// 1/200 of the cost. Shapes: snapshot_tensor.h; r coordinates, r <= K.
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"

#include <vector>

namespace palpable {

/// (K x K) lower triangle of A^T W A, read in one pass. @throws Error if values are not finite
[[nodiscard]] Eigen::MatrixXd gram_of(const SnapshotRows& snapshots,
                                      const Eigen::VectorXd& weights);

/// A D^-1 = Q C with Q orthonormal in the weighted norm and D diagonal, the scale of each snapshot.
struct PodCoordinates {
  Eigen::MatrixXd C;            ///< (r x K) rows orthogonal, largest norm first
  Eigen::MatrixXd combination;  ///< (K x r) Q = A combination
  double lost = 0;              ///< relative norm of what the r coordinates leave out
};

/// From the eigenvectors of the Gram matrix: D^-1 A^T W A D^-1 = V S^2 V^T gives C = S V^T and
/// Q = A D^-1 V S^-1 ("method of snapshots", Sirovich 1987). The Gram matrix squares the condition
/// number: directions below 1e-7 of the largest are lost, whatever `lose` is.
/// @param gram   (K x K) lower triangle
/// @param scale  (K) D, > 0
/// @param lose   relative norm that the coordinates may leave out
/// @throws Error if the snapshots are all zero
[[nodiscard]] PodCoordinates pod_coordinates(const Eigen::MatrixXd& gram,
                                             const Eigen::VectorXd& scale, double lose);

/// (p) of (n_j): factors d^j > 0 whose products approximate the norms, with the least mean square
/// difference of logarithms; exact for p = 1. Norms of zero count as 1. Dividing a tensor by these
/// factors gives all snapshots nearly the same norm, and separated modes of the quotient are
/// separated modes of the tensor, multiplied by the factors.
[[nodiscard]] std::vector<Eigen::VectorXd> separated_norms(const Eigen::VectorXd& norms,
                                                           const std::vector<int>& sizes);

}  // namespace palpable
