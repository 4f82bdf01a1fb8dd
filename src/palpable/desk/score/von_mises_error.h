/// @file
/// How wrong a drawn stress is, against the true one.
#pragma once

#include <Eigen/Core>

namespace palpable {

/// The worst vertex against the field's own maximum: max |found - truth| / max truth. Where the
/// truth is free of stress, 0 for a found body that is too, else infinite.
/// @param truth, found  (N) Pa, von Mises stress at the vertices of one skin
/// @throws ContractViolation when they differ in length or are empty
[[nodiscard]] double von_mises_error(const Eigen::VectorXd& truth, const Eigen::VectorXd& found);

}  // namespace palpable
