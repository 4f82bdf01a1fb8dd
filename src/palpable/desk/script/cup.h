/// @file
/// The sequence "cup": a hand pushes a cup against the body, releases it and leaves it there.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>

namespace palpable {

/// From about frame 170 to the end the cup stands still and reaches 3 to 7 mm into the undeformed
/// body. At the contact, the angle between its normal and the ray to the left eye is below 70
/// degrees.
/// @throws Error when the cup cannot be brought to the body in this way
[[nodiscard]] Sequence plan_cup(const DeskBody& body, int frames, std::uint64_t seed);

}  // namespace palpable
