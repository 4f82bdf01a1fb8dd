/// @file
/// How wrong a felt force is, against the true one.
#pragma once

#include <Eigen/Core>

#include <span>

namespace palpable {

/// |sum of the felt forces - truth| / |truth|: of the resultants, direction included. Without a
/// felt touch it is 1. Where nothing truly presses it is 0 when nothing is felt, else infinite.
/// @param truth  N, of all that touches the body, body frame
/// @param felt   N, a force for each felt touch, body frame; none: nothing was felt
[[nodiscard]] double force_error(const Eigen::Vector3d& truth,
                                 std::span<const Eigen::Vector3d> felt);

}  // namespace palpable
