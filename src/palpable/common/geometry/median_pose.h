/// @file
/// A robust mean of several measurements of one pose.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <span>

namespace palpable {

/// The mean of the half of the poses (rounded up) nearest to the one whose distances to all others
/// have the smallest sum. Almost half of the poses may be wrong. A turn of 1 rad counts as `reach`
/// m: the distance from the origin of the source frame at which points matter.
/// @param poses  at least one
[[nodiscard]] Rigid3 median_pose(std::span<const Rigid3> poses, double reach);

}  // namespace palpable
