/// @file
/// The error of a drawn stress with respect to the true one.
#pragma once

#include <Eigen/Core>

namespace palpable {

/// The largest error of a vertex relative to the largest true stress: max |found - truth| / max
/// truth. If the true stress is 0 everywhere, the error is 0 when the found one is 0, too, and
/// otherwise infinite.
/// @param truth, found  (N) Pa, von Mises stress at the vertices of one skin
/// @throws ContractViolation when they differ in length or are empty
[[nodiscard]] double von_mises_error(const Eigen::VectorXd& truth, const Eigen::VectorXd& found);

}  // namespace palpable
