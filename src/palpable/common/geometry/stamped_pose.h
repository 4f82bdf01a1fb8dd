/// @file
/// A camera's pose at a moment, and the path that such poses make.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <optional>
#include <vector>

namespace palpable {

struct StampedPose {
  double time = 0;  ///< s
  Rigid3 world_from_camera = Rigid3::Identity();
};

/// The pose whose time is nearest, the later one of two that are as near.
/// @param path    in order of time
/// @param within  s: nothing when the nearest is farther away than that
[[nodiscard]] std::optional<Rigid3> pose_nearest(const std::vector<StampedPose>& path, double time,
                                                 double within);

}  // namespace palpable
