/// @file
/// Camera poses with their times, and look-up in a path of such poses.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <optional>
#include <vector>

namespace palpable {

struct StampedPose {
  double time = 0;  ///< s
  Rigid3 world_from_camera = Rigid3::Identity();
};

/// The pose whose time is nearest to `time`, the later one of two that are equally near.
/// @param path    in order of time
/// @param within  s: nothing is returned if the nearest pose is farther away in time
[[nodiscard]] std::optional<Rigid3> pose_nearest(const std::vector<StampedPose>& path, double time,
                                                 double within);

}  // namespace palpable
