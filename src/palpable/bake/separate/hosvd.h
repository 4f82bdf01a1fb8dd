/// @file
/// Tucker form of a tensor by higher-order singular value decomposition. Shapes: snapshot_tensor.h;
/// R_0 is the rank of space, R_j that of parameter j.
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"

#include <vector>

namespace palpable {

/// A ~= S x_0 U_0 x_1 U_1 ... x_p U_p: a small tensor and a basis for each direction.
struct Tucker {
  Eigen::MatrixXd core;            ///< (R_0 x R_1 ... R_p), last parameter fastest
  std::vector<Eigen::MatrixXd> U;  ///< (1 + p) (N x R_0), (n_j x R_j): orthonormal columns
  /// Upper bound of the relative error: the square root of the sum of the squares of all singular
  /// values that were cut off in all unfoldings, divided by the tensor's norm.
  double bound = 0;

  [[nodiscard]] std::vector<int> ranks() const;  ///< R_0, R_1 ... R_p
};

enum class HosvdOrder {
  /// All bases from the tensor itself (De Lathauwer, De Moor, Vandewalle 2000, property 10): the
  /// error is at most the bound.
  kAtOnce,
  /// ST-HOSVD: each basis from the tensor as truncated by the bases before it (Vannieuwenhoven,
  /// Vandebril, Meerbergen 2012): cheaper, and the error equals the bound.
  kSequential
};

/// Truncates each direction, space first, to the smallest rank at which the tail of its singular
/// values is at most tolerance / sqrt(1 + p) of the tensor's norm; then the bound is at most the
/// tolerance.
/// @throws Error if the snapshots are all zero or not finite
[[nodiscard]] Tucker hosvd(const SnapshotTensor& snapshots, double tolerance, HosvdOrder order);

/// (N x K) the snapshots as the Tucker form reproduces them.
[[nodiscard]] Eigen::MatrixXd expand(const Tucker& tucker);

/// The same as separated modes over all parameters together (sizes {K}): F = U_0, R_0 modes.
[[nodiscard]] SeparatedTensor as_two_factors(const Tucker& tucker);

}  // namespace palpable
