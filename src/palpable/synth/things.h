/// @file
/// Things that hands hold: a pencil and a cup, as capsules.
///
/// Metres. Cup frame: origin in the middle of the bottom, Z up its axis, its handle along X.
#pragma once

#include "palpable/synth/hand_path.h"

#include <vector>

namespace palpable {

/// A hand that holds a pencil as one writes with it; the tip is the middle of the lead's rounding.
[[nodiscard]] HandTool hand_with_pencil();

/// A hand round a cup that stands upright: thumb up, fingers level. The tip is on the cup's axis at
/// kGripHeight above its bottom; the palm looks along -Z of the wrist.
[[nodiscard]] HandTool hand_round_cup();

inline constexpr double kCupRadius = 0.040;  ///< outside
inline constexpr double kCupHeight = 0.092;
inline constexpr double kCupWallRadius = 0.003;  ///< of the wall's rounding: half its thickness
inline constexpr double kGripHeight = 0.058;

inline constexpr int kCupStaves = 120;
inline constexpr int kCupHandleParts = 7;

/// In this order kCupStaves upright capsules side by side, whose envelope is within 0.17 mm of the
/// wall, and kCupHandleParts of the handle; desk frame.
[[nodiscard]] std::vector<HandCapsule> cup_capsules(const Rigid3& desk_from_cup);

}  // namespace palpable
