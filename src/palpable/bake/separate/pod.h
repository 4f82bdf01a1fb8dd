/// @file
/// Proper orthogonal decomposition: the best approximation by a sum of m modes (Eckart and Young
/// 1936), all parameters taken together. Shapes: snapshot_tensor.h.
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"

#include <cstdint>
#include <vector>

namespace palpable {

/// A = U S V^T by LAPACK, truncated at the first m where the tail of the singular values is below
/// the tolerance:
///
///     | A - A_m |^2 = s_{m+1}^2 + s_{m+2}^2 + ...
///
/// F = U S and one table of functions, V, over all parameters together (sizes {K}).
/// @throws Error if the snapshots are all zero or not finite
[[nodiscard]] Separation pod(const SnapshotTensor& snapshots, const ReductionGoal& goal);

struct RandomisedPodSettings {
  int rank = 100;          ///< modes that are computed
  int oversampling = 20;   ///< random directions beyond `rank`; more lower the error
  int passes = 2;          ///< over the store: 1 or 2
  std::uint64_t seed = 1;  ///< the same seed gives the same modes
};

/// A randomised POD in one or two passes over a table that need not fit into memory, in the norm
/// |a|_w^2 = sum_n w_n a_n^2.
///
///     pass 1      Y = A Omega      (N x l), Omega random (K x l), l = rank + oversampling
///                 Q R = Y          (N x l)
///     pass 2      B = Q^T A        (l x K)
///     or, in the same pass 1,
///                 W = Psi A        (2 l x K), Psi random (2 l x N)
///                 B = (Psi Q)^+ W  (l x K)
///
/// and the SVD of B. Two passes: Halko, Martinsson, Tropp 2011, 4.1 and 5.1; one pass: Tropp,
/// Yurtsever, Udell, Cevher 2017.
///
/// Memory: N l and 3 l K doubles and a block of rows. With two passes the error is within a few per
/// cent of the best at that rank if the singular values fall fast; with one pass, within a factor
/// of about three.
struct RandomisedPod {
  Eigen::MatrixXd Q;  ///< (N x rank) orthonormal in the weighted norm
  Eigen::MatrixXd C;  ///< (rank x K) coordinates: A ~= Q C; rows orthogonal, largest norm first
};

/// @throws Error if values are not finite
/// @throws ContractViolation unless rank >= 1, oversampling >= 0, passes is 1 or 2, weights > 0
[[nodiscard]] RandomisedPod randomised_pod(const SnapshotRows& snapshots,
                                           const Eigen::VectorXd& weights,
                                           const RandomisedPodSettings& settings);

/// (K x K) lower triangle of A^T W A, read in one pass. @throws Error if values are not finite
[[nodiscard]] Eigen::MatrixXd gram_of(const SnapshotRows& snapshots,
                                      const Eigen::VectorXd& weights);

/// Snapshots in the coordinates of their own POD basis, r of them, r <= K. There every method finds
/// the same modes at 1/200 of the cost.
///
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
