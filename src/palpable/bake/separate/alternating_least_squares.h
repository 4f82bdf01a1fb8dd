/// @file
/// One round of alternating least squares over all modes. Greedy PGD runs it after each new mode,
/// CP-ALS several times for each number of modes. Shapes: snapshot_tensor.h.
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"

namespace palpable {

/// Replaces each table of functions in turn by the least squares solution for it while all other
/// tables are kept; the parameters come first, space last:
///
///     G^j = argmin | A - F o G^1 o ... o G^p |     with the Gram matrix  F^T F * (G^l)^T G^l * ...
///
/// (Kolda and Bader 2009, Sec. 3.4). A ridge of 1e-13, relative to the mean diagonal of the Gram
/// matrix, prevents nearly parallel modes from growing against each other.
/// @param left  (N x K) the residual, A minus the modes; updated when the round lowers its norm
/// @return whether the round lowered the residual; if not, `separated` and `left` are unchanged
bool improve_all_functions(const SnapshotTensor& A, SeparatedTensor& separated,
                           Eigen::MatrixXd& left);

}  // namespace palpable
