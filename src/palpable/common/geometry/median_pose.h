/// @file
/// A robust mean of several measurements of one pose.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <span>

namespace palpable {

/// Takes the pose whose distances to all others have the smallest sum, and returns the mean of the
/// half of the poses (rounded up) that are nearest to it. Almost half of the poses may be outliers.
/// @param poses  at least one
/// @param reach  m: a rotation of 1 rad counts as this distance. It is the distance from the origin
///               of the source frame at which points matter
[[nodiscard]] Rigid3 median_pose(std::span<const Rigid3> poses, double reach);

}  // namespace palpable
