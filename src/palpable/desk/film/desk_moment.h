/// @file
/// What one frame shows: where camera and movers are while its shutter is open.
#pragma once

#include "palpable/desk/script/sequence.h"

#include <functional>

namespace palpable {

/// The shutter is open around the frame's own moment, and the middle row is read at it. So camera
/// and movers are asked for moments up to half a frame away.
struct DeskMoment {
  int frame = 0;
  std::function<Rigid3(double)> camera_from_desk;  ///< at a moment
  std::function<Movers(double)> movers;            ///< at a moment
  RigState rig;
};

[[nodiscard]] inline DeskMoment moment_of(const Sequence& sequence, int frame) {
  return {frame, sequence.camera_from_desk, sequence.movers, sequence.rig(frame)};
}

}  // namespace palpable
