/// @file
/// A hand that works in front of a moving camera: it enters, moves about and leaves. It is not
/// meant to touch anything.
#pragma once

#include "palpable/desk/script/camera_motions.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>
#include <functional>

namespace palpable {

/// The hand belongs to the person who carries the camera: its path is defined in a frame that moves
/// with the camera. It covers 15 to 40 % of the ZED Mini's left view in more than half of the
/// frames from kFramesWithoutHand on.
/// @param path  path of the camera without tremor, because the hand does not shake with the camera
[[nodiscard]] std::function<Movers(double)> working_hand(CameraPath path, int frames,
                                                         std::uint64_t seed);

}  // namespace palpable
