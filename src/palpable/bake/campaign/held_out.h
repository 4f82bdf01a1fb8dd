/// @file
/// How wrong a reduced body is where it was not made from: against states solved afresh, at levels
/// between its own.
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

namespace palpable {

/// Of the body as the live half evaluates it (single precision, interpolated between levels), on
/// its skin.
struct HeldOutErrors {
  /// (L x S) |u - u_r| / |u| of each snapshot, |.|^2 an integral over the skin (nodal areas).
  Eigen::MatrixXd displacement;
  double displacement_pooled = 0;  ///< of all together
  /// (L x S) the worst vertex: largest | vM - vM_r | over the largest vM of the same snapshot.
  Eigen::MatrixXd von_mises;

  Eigen::VectorXd levels = {};  ///< (L)
  /// As the body file keeps them.
  [[nodiscard]] HeldOutRecord record() const;

  [[nodiscard]] double displacement_median() const;
  [[nodiscard]] double von_mises_median() const;
};

/// Which state of the body a held-out one is compared with.
enum class HeldOutAt {
  kLevel,  ///< the one at its level: loads are the same
  kDepth   ///< the one that is pressed as deep, as the live half finds it from a measured depth
};

/// @pre body.is_settled()
/// @param held_out  units of the point from which the body is (as ReduceSettings::at), or to which
///                  it was settled
/// @throws Error if a unit is missing, or the store is of another mesh or other sites
[[nodiscard]] HeldOutErrors held_out_errors(const ReducedBody& body, const SnapshotStore& held_out,
                                            int point = 0, HeldOutAt at = HeldOutAt::kLevel);

}  // namespace palpable
