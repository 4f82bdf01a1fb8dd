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

/// One squeeze by a hand that comes in from the right for it.
struct OneSqueeze {
  HandPath path;
  std::vector<PlannedTouch> touches;  ///< finger and thumb
};

/// Looks for the place where the camera sees it best.
/// @param first  the frame in which the hand is still outside of the picture
/// @param pace   of all that it does; 1 takes 90 frames until it has let go
/// @return nothing where no hand can come round two sides of the body
[[nodiscard]] std::optional<OneSqueeze> plan_one_squeeze(const DeskBody& body,
                                                         const Rigid3& desk_from_body, double first,
                                                         double pace, std::uint64_t seed);

/// Each squeeze is checked against the body's surface: finger and thumb touch it at the same time,
/// the hand touches it nowhere else, and the camera sees at least half of what touches
/// (seen_share.h). The camera stands on its tripod; rig, faults and look have their defaults.
/// @throws Error when the body has no two sides 30 to 70 mm apart that a hand can come round
[[nodiscard]] Sequence plan_squeezes(const DeskBody& body, int frames, std::uint64_t seed);

}  // namespace palpable
