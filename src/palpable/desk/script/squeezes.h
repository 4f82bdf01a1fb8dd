/// @file
/// The sequence "squeeze": finger and thumb of one hand press the body from two sides at once.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/hand_path.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace palpable {

/// One squeeze by a hand that enters from the right.
struct OneSqueeze {
  HandPath path;
  std::vector<PlannedTouch> touches;  ///< finger and thumb
};

/// Plans one squeeze where the camera sees it best.
/// @param first  first frame, in which the hand is still outside of the picture
/// @param pace   ratio by which all motions are slowed down; with 1, the hand has released the body
///               after 90 frames
/// @return nothing when no hand can reach round two sides of the body
[[nodiscard]] std::optional<OneSqueeze> plan_one_squeeze(const DeskBody& body,
                                                         const Rigid3& desk_from_body, double first,
                                                         double pace, std::uint64_t seed);

/// Plans the sequence. Each squeeze is checked against the body's surface: finger and thumb touch
/// it at the same time, the hand touches it nowhere else, and the camera sees at least half of the
/// touching surface (seen_share.h). The camera is on a tripod; rig, faults and look have their
/// defaults.
/// @throws Error when the body has no two sides 30 to 70 mm apart that a hand can reach round
[[nodiscard]] Sequence plan_squeezes(const DeskBody& body, int frames, std::uint64_t seed);

}  // namespace palpable
