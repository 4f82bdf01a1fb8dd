/// @file
/// Sequences in which hands press the body: fingers, a flat hand, two hands, a sliding finger, a
/// pencil. Each plan is checked against the body's surface: the hands touch it where planned and
/// nowhere else.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>
#include <string_view>

namespace palpable {

/// One of "press", "press-axial", "press-behind", "pencil", "slide", "palm", "rest", "two-hands".
/// The camera stands on its tripod; rig, faults and look (but for left_free) have their defaults.
/// @throws Error when the body cannot be pressed as the sequence demands
[[nodiscard]] Sequence plan_presses(std::string_view name, const DeskBody& body, int frames,
                                    std::uint64_t seed);

}  // namespace palpable
