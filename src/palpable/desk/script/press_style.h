/// @file
/// How each kind of sequence with presses presses: with what, how deep, from where.
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
  double least_hold = 4;       ///< frames at the full depth
  double most_hold = 14;
  bool slides = false;      ///< along the surface, from one target to another
  bool comes_near = false;  ///< now and then the hand passes close to the camera
  bool two_hands = false;
};

/// Bounds for presses whose touching surface the camera sees: it faces the eye within 68 degrees
/// (docs/benchmark.md promises 70) and the press is at least 30 degrees off the line of sight.
[[nodiscard]] PressRules rules_where_seen();

/// @param name  "press", "press-axial", "press-behind", "pencil", "slide", "palm", "rest" or
/// "two-hands"
/// @throws ContractViolation for another name
[[nodiscard]] PressStyle press_style(std::string_view name);

}  // namespace palpable
