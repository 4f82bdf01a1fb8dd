/// @file
/// A camera's pose at a moment.
#pragma once

#include "palpable/geometry/rigid.h"

namespace palpable {

struct StampedPose {
  double time = 0;  ///< s
  Rigid3 world_from_camera = Rigid3::Identity();
};

}  // namespace palpable
