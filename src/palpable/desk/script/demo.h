/// @file
/// The sequence "demo": the clip of ./demo.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>

namespace palpable {

/// A finger presses the body three times; in between, the hand passes in front of the body and
/// behind it. Then finger and thumb squeeze the body, if that is possible. The hand's motion is
/// written for 330 frames after the first kFramesWithoutHand and stretched to the requested length.
/// @throws Error when no place of the body can be pressed where the camera sees it
[[nodiscard]] Sequence plan_demo(const DeskBody& body, int frames, std::uint64_t seed);

}  // namespace palpable
