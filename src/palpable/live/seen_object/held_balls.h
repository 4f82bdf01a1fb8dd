/// @file
/// What is no longer seen need not have left. A thing that was there a moment ago is
///
///     here       something that presses is seen there, nearer or farther: it has become that
///     gone       the room is seen there: what lay before it is free
///     unknown    neither: a hole of the matcher, something before it, out of the picture
///
/// Unknown holds, so that a press does not drop to nothing for one frame without a measurement.
/// After a while it fades, as balls that shrink.
#pragma once

#include "palpable/common/contact/object_ball.h"
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

class HeldBalls {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit HeldBalls(const HoldSettings& settings = {});

  /// No frame of so many balls allocates anything.
  void reserve(std::size_t balls) { before_.reserve(balls); }

  /// Adds to `balls`, those of the frame at `time` (s), the ones of the frame before that are
  /// unknown now. Of a thing that is seen, if only in part, nothing is held: it may have moved.
  /// Allocates nothing once there were as many.
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
