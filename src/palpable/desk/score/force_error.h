/// @file
/// The error of a computed contact force with respect to the true one.
#pragma once

#include <Eigen/Core>

#include <span>

namespace palpable {

/// |sum of the felt forces - truth| / |truth|, the error of the resultant including its direction.
/// It is 1 if no touch was felt. If the true force is 0, it is 0 when nothing was felt and
/// otherwise infinite.
/// @param truth  N, total contact force on the body, body frame
/// @param felt   N, the force of each felt touch, body frame; empty: nothing was felt
[[nodiscard]] double force_error(const Eigen::Vector3d& truth,
                                 std::span<const Eigen::Vector3d> felt);

}  // namespace palpable
