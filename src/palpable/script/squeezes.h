/// @file
/// The sequence "squeeze": finger and thumb of one hand press the body from two sides at once.
#pragma once

#include "palpable/script/desk_body.h"
#include "palpable/script/sequence.h"

#include <cstdint>

namespace palpable {

/// Each squeeze is checked against the body's surface: finger and thumb touch it at the same time,
/// the hand touches it nowhere else, and the camera sees at least half of what touches
/// (seen_share.h). The camera stands on its tripod; rig, faults and look have their defaults.
/// @throws Error when the body has no two sides 30 to 70 mm apart that a hand can come round
[[nodiscard]] Sequence plan_squeezes(const DeskBody& body, int frames, std::uint64_t seed);

}  // namespace palpable
