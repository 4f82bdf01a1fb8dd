/// @file
/// Sequences in which hands press the body: a finger, a flat hand, two hands, a sliding finger or a
/// pencil, also one that is turned in view before. Each plan is checked against the body's surface:
/// the hands touch it only where planned.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>
#include <string_view>

namespace palpable {

/// Plans one of "press", "press-axial", "press-behind", "pencil", "pencil-turn", "slide", "palm",
/// "rest", "two-hands". The camera is on a tripod; rig, faults and look, except left_free, have
/// their defaults.
/// @throws Error when the body cannot be pressed as the sequence requires
[[nodiscard]] Sequence plan_presses(std::string_view name, const DeskBody& body, int frames,
                                    std::uint64_t seed);

}  // namespace palpable
