/// @file
/// A hand at work before a moving camera: it comes, does something and goes. It is not meant to
/// touch anything.
#pragma once

#include "palpable/desk/script/camera_motions.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>
#include <functional>

namespace palpable {

/// The hand belongs to whoever carries the camera: its path is written in a frame that moves with
/// the camera. It covers 15-40 % of the ZED Mini's left view in more than half of the frames from
/// kFramesWithoutHand on.
/// @param path  of the camera, without tremor: the hand does not shake as the camera does
[[nodiscard]] std::function<Movers(double)> working_hand(CameraPath path, int frames,
                                                         std::uint64_t seed);

}  // namespace palpable
