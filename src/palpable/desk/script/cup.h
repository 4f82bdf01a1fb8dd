/// @file
/// The sequence "cup": a hand puts a cup against the body, lets go and leaves it there.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>

namespace palpable {

/// The cup stands from about frame 170 on and reaches 3-7 mm into the undeformed body until the
/// end. Where it touches, its surface faces the left eye within 70 degrees.
/// @throws Error when the cup cannot be brought to the body that way
[[nodiscard]] Sequence plan_cup(const DeskBody& body, int frames, std::uint64_t seed);

}  // namespace palpable
