/// @file
/// The sequence "demo": the clip of ./demo.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>

namespace palpable {

/// In a calm room a finger presses three times; in between the hand passes before the body and
/// behind it. The hand's motion is written for 300 frames and stretched to the length.
/// @throws Error when the body has no sites that can be pressed where the camera sees it
[[nodiscard]] Sequence plan_demo(const DeskBody& body, int frames, std::uint64_t seed);

}  // namespace palpable
