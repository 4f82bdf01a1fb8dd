/// @file
/// What several measurements of one pose agree on.
#pragma once

#include "palpable/geometry/rigid.h"

#include <span>

namespace palpable {

/// The mean of the half of the poses (rounded up) that lie nearest to the one from which all lie
/// least far in sum: half of them may be anything. A turn of 1 rad counts as `reach` m, which is
/// how far from the origin of the pose's source frame a point matters.
/// @param poses  at least one
[[nodiscard]] Rigid3 median_pose(std::span<const Rigid3> poses, double reach);

}  // namespace palpable
