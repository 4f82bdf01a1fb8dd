/// @file
/// The error of the position and rotation at which a body is drawn.
///
///   N  vertices of the body's skin
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

namespace palpable {

/// The largest distance, m, of a vertex of the body at rest between its true pose and the drawn
/// pose, from translation and rotation together. Deformation by touches is not included.
/// @param rest          (3 x N) m, body frame, N > 0
/// @param truth, drawn  camera_from_body of one frame
/// @throws ContractViolation without a vertex
[[nodiscard]] double placement_error(const Eigen::Matrix3Xd& rest, const Rigid3& truth,
                                     const Rigid3& drawn);

}  // namespace palpable
