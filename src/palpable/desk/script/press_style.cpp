#include "palpable/desk/script/press_style.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/things.h"

#include <cmath>

namespace palpable {

namespace {

const ArmSide kPastTheCamera{{0.85, -0.45, 0.25}, {0.85, -0.30, 0.40}};

}  // namespace

PressRules rules_where_seen() {
  PressRules rules;
  rules.least_facing = std::cos(68.0 * kDegree);
  rules.most_facing = std::cos(30.0 * kDegree);
  rules.most_x = -0.20;
  return rules;
}

PressStyle press_style(std::string_view name) {
  PressStyle style;
  style.rules = rules_where_seen();
  if (name == "press") {
    style.comes_near = true;
  } else if (name == "pencil") {
    style.what = "pencil";
    style.tool = hand_with_pencil();
    style.most_depth = 0.010;
  } else if (name == "pencil-turn") {
    style.what = "pencil";
    style.tool = hand_with_pencil();
    style.least_depth = 0.0045;
    style.most_depth = 0.010;
    style.turns = true;
    // The hand comes past the camera, and the tip points away from it: the camera sees the barrel,
    // but of the tip not the side that touches.
    style.arm = kPastTheCamera;
    style.rules.least_facing = -0.75;
    style.rules.most_facing = -0.25;
    style.rules.most_x = 0.30;
    style.rules.eye_clearance = 0.06;
  } else if (name == "slide") {
    style.what = "slide";
    style.slides = true;
    style.least_hold = 20;
    style.most_hold = 45;
    style.least_depth = 0.003;
    style.most_depth = 0.006;
  } else if (name == "palm") {
    style.what = "palm";
    style.tool = flat_hand();
    style.least_depth = 0.004;
    style.most_depth = 0.009;
    style.rules.least_facing = -0.7;
    style.rules.most_facing = 1.0;
    style.rules.seen = false;
    style.rules.near = 0.11;
    style.rules.clearance = 0.0;
  } else if (name == "rest") {
    style.least_depth = 0.003;
    style.most_depth = 0.006;
    style.least_hold = 600;  // 20 s
    style.most_hold = 602;
  } else if (name == "two-hands") {
    style.two_hands = true;
  } else if (name == "press-axial") {
    style.arm = kPastTheCamera;
    style.rules.least_facing = -1.0;
    style.rules.most_facing = -std::cos(32.0 * kDegree);
    style.rules.most_x = 1.0;
    style.rules.seen = false;
    style.rules.eye_clearance = 0.06;
  } else {
    PALPABLE_EXPECT(name == "press-behind", "the sequence is one of those with presses");
    style.rules.least_facing = std::cos(40.0 * kDegree);
    style.rules.most_facing = 1.0;
    style.rules.most_x = 0.30;
  }
  return style;
}

}  // namespace palpable
