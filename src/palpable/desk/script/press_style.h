/// @file
/// The tool, depth and direction of the presses in each kind of sequence.
#pragma once

#include "palpable/desk/script/hand_path.h"
#include "palpable/desk/script/press_search.h"

#include <string>
#include <string_view>

namespace palpable {

struct PressStyle {
  std::string what = "finger";  ///< PlannedTouch::what
  HandTool tool = index_finger();
  ArmSide arm;
  PressRules rules;
  double least_depth = 0.003;  ///< m
  double most_depth = 0.014;   ///< m
  double least_hold = 4;       ///< shortest time at the full depth, frames
  double most_hold = 14;       ///< longest time at the full depth, frames
  bool slides = false;         ///< whether it slides along the surface to another target
  bool comes_near = false;     ///< whether the hand sometimes passes close to the camera
  bool turns = false;          ///< whether the hand is turned before the camera before each press
  bool two_hands = false;
};

/// Rules for presses whose touching surface the camera sees: the angle between its normal and the
/// ray to the eye is at most 68 degrees (docs/benchmark.md states 70), and the press is at least 30
/// degrees away from the line of sight.
[[nodiscard]] PressRules rules_where_seen();

/// @param name  "press", "press-axial", "press-behind", "pencil", "pencil-turn", "slide", "palm",
///              "rest" or "two-hands"
/// @throws ContractViolation for another name
[[nodiscard]] PressStyle press_style(std::string_view name);

}  // namespace palpable
