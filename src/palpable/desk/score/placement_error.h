/// @file
/// How far off its true place a body is drawn.
///
///   N  vertices of the body's skin
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

namespace palpable {

/// The farthest way, m, of a vertex of the body at rest between where the body truly stands and
/// where it was drawn: of shift and turn. What a touch does to the skin has no part in it.
/// @param rest          (3 x N) m, body frame, N > 0
/// @param truth, drawn  camera_from_body of one frame
/// @throws ContractViolation without a vertex
[[nodiscard]] double placement_error(const Eigen::Matrix3Xd& rest, const Rigid3& truth,
                                     const Rigid3& drawn);

}  // namespace palpable
