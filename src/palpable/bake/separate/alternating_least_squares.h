/// @file
/// One round of alternating least squares over all modes: what greedy PGD updates with, and what
/// CP-ALS repeats. Shapes: snapshot_tensor.h.
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"

namespace palpable {

/// Each table of functions in turn, those of the parameters first and space last, is made the least
/// squares answer to the others:
///
///     G^j = argmin | A - F o G^1 o ... o G^p |     with the Gram matrix  F^T F * (G^l)^T G^l * ...
///
/// (Kolda and Bader 2009, Sec. 3.4). A ridge of 1e-13 keeps nearly parallel modes from growing
/// against each other.
/// @param left  (N x K) A less the modes; made anew where the round helps
/// @return whether it did; otherwise nothing has changed
bool improve_all_functions(const SnapshotTensor& A, SeparatedTensor& separated,
                           Eigen::MatrixXd& left);

}  // namespace palpable
