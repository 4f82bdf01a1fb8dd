/// @file
/// The sequence "cup-turn": a hand turns a cup before the camera, then pushes it against the body
/// with the side that the camera saw before the turn.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>

namespace palpable {

/// From frame 92 on, the cup is turned by 180 to 200 degrees within 1.6 to 2.2 s about its upright
/// axis (NamedSpan "turned"), pushed 4.5 to 7 mm into the body, withdrawn and turned back, again
/// and again. It stays in the hand and follows it rigidly. The pushes lead away from the camera: at
/// the contact, the angle between the cup's normal and the ray to the left eye is above 105
/// degrees. In the first frame of the turn it is below 75 degrees there.
/// @throws Error when the cup cannot be brought to the body in this way
[[nodiscard]] Sequence plan_cup_turn(const DeskBody& body, int frames, std::uint64_t seed);

}  // namespace palpable
