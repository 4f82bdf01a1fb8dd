/// @file
/// Poses as callers have them: 16 numbers.
#pragma once

#include "palpable/common/geometry/rigid.h"

namespace palpable {

/// @param rows  16 numbers in the order that palpable.h states
/// @param name  of the argument, for the error message
/// @throws Failure when the matrix is not a rotation and a translation
[[nodiscard]] Rigid3 pose_of(const double* rows, const char* name);

/// The inverse of pose_of().
void write_pose(const Rigid3& pose, double rows[16]);

}  // namespace palpable
