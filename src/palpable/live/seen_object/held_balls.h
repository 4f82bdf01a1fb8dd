/// @file
/// Keeps the balls of a thing for a while after it is no longer measured. What the pixels of a ball
/// of the last frame show now decides about it:
///
///     a presser  at any depth: the ball is dropped, new balls stand for it
///     the room   the space before the room is free: the ball is dropped
///     unknown    a hole of the matcher, an occluder before it, or outside of the picture: the ball
///                is held
///
/// Holding keeps a press from dropping to nothing in a single frame without a measurement. After a
/// while held balls fade: they shrink to nothing.
#pragma once

#include "palpable/common/contact/pressing_surface.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"

#include <cstddef>
#include <vector>

namespace palpable {

struct HoldSettings {
  double hold = 0.3;  ///< s for which an unknown ball stays as it was
  double fade = 0.3;  ///< s in which it then shrinks to nothing; > 0
};

/// Adds the held balls of earlier frames to those of a frame.
class HeldBalls {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit HeldBalls(const HoldSettings& settings = {});

  /// Reserves memory: frames with up to this many balls then allocate nothing.
  void reserve(std::size_t balls) { before_.reserve(balls); }

  /// Adds held balls to `balls`, the balls measured in the frame at `time` (s). A frame with at
  /// least half as many measured balls as the last one still shows the thing, which may have moved:
  /// then none of the last frame's measured balls is held. Allocates nothing once there were as
  /// many balls.
  /// @param depth, shows  as ObjectSurface::build; `shows` of the depth's size
  void recall(const DepthImage& depth, const MaskImage& shows, const PinholeCamera& camera,
              const Rigid3& camera_from_body, double time, std::vector<ObjectBall>& balls);

 private:
  HoldSettings settings_;
  double time_ = 0;
  std::vector<ObjectBall> before_;  // as large as they were when they were measured
  std::size_t measured_before_ = 0;
};

}  // namespace palpable
