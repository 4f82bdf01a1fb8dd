/// @file
/// The sequence "beams": two beams on the desk, one above the other. A finger presses the upper one
/// onto the lower one and releases it (the paper's Sec. 5.1 and Fig. 12).
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>
#include <span>

namespace palpable {

/// A body of a scene with several bodies.
struct PlacedDeskBody {
  DeskBody body;
  Rigid3 scene_from_body = Rigid3::Identity();
};

/// The length for which docs/benchmark.md states properties.
inline constexpr int kBeamsFrames = 420;

/// The scene stands in the middle of the desk, turned so that the free ends of the beams, the ends
/// with sites, are at the right, from where the hand comes. Each press aims at a site in the outer
/// third of the upper beam and moves down until the free end lies on the lower beam, and 3 to 8 mm
/// farther. Sequence::desk_from_body is that of the first body.
/// @param bodies  two, in any order, each with its sites on top
/// @throws Error when they are not two beams above each other with a gap of 2 to 60 mm, or when no
///         hand can press the upper one without touching anything else
[[nodiscard]] Sequence plan_beams(std::span<const PlacedDeskBody> bodies, int frames,
                                  std::uint64_t seed);

}  // namespace palpable
