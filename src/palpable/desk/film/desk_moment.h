/// @file
/// The scene of one frame: the poses of camera and movers while its shutter is open.
#pragma once

#include "palpable/desk/script/sequence.h"

#include <functional>

namespace palpable {

/// Times are in frames. The exposure is centred at the time `frame`, and so is the readout of the
/// rows. So the renderer evaluates camera and movers at times up to half a frame away.
struct DeskMoment {
  int frame = 0;
  std::function<Rigid3(double)> camera_from_desk;  ///< at a time
  std::function<Movers(double)> movers;            ///< at a time
  RigState rig;
};

[[nodiscard]] inline DeskMoment moment_of(const Sequence& sequence, int frame) {
  return {frame, sequence.camera_from_desk, sequence.movers, sequence.rig(frame)};
}

}  // namespace palpable
