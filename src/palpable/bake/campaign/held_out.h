/// @file
/// Errors of a reduced body at held-out states: full-order solutions at load levels between those
/// of its snapshots.
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

namespace palpable {

/// Errors on the skin of the body as the live half evaluates it (single precision, interpolated
/// between levels).
struct HeldOutErrors {
  /// (L x S) |u - u_r| / |u| of each snapshot, |.|^2 an integral over the skin (nodal areas).
  Eigen::MatrixXd displacement;
  double displacement_pooled = 0;  ///< of all snapshots together
  /// (L x S) error of the worst vertex: largest | vM - vM_r | over the largest vM of the same
  /// snapshot.
  Eigen::MatrixXd von_mises;

  Eigen::VectorXd levels = {};  ///< (L)
  /// As the body file keeps them.
  [[nodiscard]] HeldOutRecord record() const;

  [[nodiscard]] double displacement_median() const;
  [[nodiscard]] double von_mises_median() const;
};

/// The state of the body with which a held-out state is compared.
enum class HeldOutAt {
  kLevel,  ///< at the same level, i.e. under the same load
  kDepth   ///< at the same press depth, which is what the live half measures
};

/// @pre body.is_settled()
/// @param held_out  store with the units of `point`, from which the body was reduced
///                  (ReduceSettings::at) or to which it was settled
/// @throws Error if a unit is missing, or the store is of another mesh or other sites
[[nodiscard]] HeldOutErrors held_out_errors(const ReducedBody& body, const SnapshotStore& held_out,
                                            int point = 0, HeldOutAt at = HeldOutAt::kLevel);

}  // namespace palpable
