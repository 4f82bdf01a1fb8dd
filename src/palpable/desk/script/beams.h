/// @file
/// The sequence "beams": two beams on the desk, one above the other; a finger presses the upper one
/// until it lies on the lower one, and lets go (the paper's Sec. 5.1 and Fig. 12).
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>
#include <span>

namespace palpable {

/// A body of a scene with several.
struct PlacedDeskBody {
  DeskBody body;
  Rigid3 scene_from_body = Rigid3::Identity();
};

/// The length that docs/benchmark.md promises something about.
inline constexpr int kBeamsFrames = 420;

/// The scene stands in the middle of the desk, turned so that the beams' free ends, those to which
/// their sites reach, are to the right, where the hand comes from. Each press aims at a site of the
/// upper beam in its outer third and goes down until its free end lies on the lower one, and 3 to 8
/// mm more. Sequence::desk_from_body is of the first body.
/// @param bodies  two, in any order, each with its sites on top
/// @throws Error when they are not two beams above each other with a gap of 2 to 60 mm, or when no
///         hand can press the upper one without meeting anything else
[[nodiscard]] Sequence plan_beams(std::span<const PlacedDeskBody> bodies, int frames,
                                  std::uint64_t seed);

}  // namespace palpable
