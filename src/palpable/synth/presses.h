/// @file
/// Sequences in which hands press the body: fingers, a flat hand, two hands, a sliding finger, a
/// pencil. Checked against the body's surface before they are handed out: touched where planned
/// and nowhere else.
#pragma once

#include "palpable/synth/sequence.h"

#include <cstdint>
#include <string_view>

namespace palpable {

/// The clip of ./demo: three presses of a finger, and the hand before the body and behind it, in a
/// calm room; the hand's whole way is stretched to the length (300 frames are natural).
/// @throws Error when the body has no sites that can be pressed where the camera sees it
[[nodiscard]] Sequence plan_demo(const DeskBody& body, int frames, std::uint64_t seed);

/// One of "press", "press-axial", "press-behind", "pencil", "slide", "palm", "two-hands". The
/// camera stands on its tripod; rig and look are left as they are by default.
/// @throws Error when the body cannot be pressed so
[[nodiscard]] Sequence plan_presses(std::string_view name, const DeskBody& body, int frames,
                                    std::uint64_t seed);

}  // namespace palpable
