#include "palpable/desk/script/things.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace palpable {

using Eigen::Vector3d;

HandTool hand_with_pencil() {
  HandGesture grip;
  grip.fingers[0] = {0.06, 0.62, 0.72, 0.30};
  grip.fingers[1] = {0.02, 0.78, 0.92, 0.45};
  grip.fingers[2] = {0.00, 0.98, 1.20, 0.60};
  grip.fingers[3] = {-0.03, 1.10, 1.25, 0.60};
  grip.thumb = {0.23, 0.43, 0.17, 0.12};
  HandTool tool;
  tool.working = tool.passing = grip;
  tool.tip = HandTool::Tip::kFixed;
  // The pencil lies from the web between thumb and index finger along the thumb's side of the index
  // finger's tip.
  const Vector3d web(0.066, 0.038, 0.012);
  const Vector3d finger = index_tip_in_wrist(grip);
  const Vector3d straight = (finger - web).normalized();
  const Vector3d side =
      (Vector3d::UnitY() - Vector3d::UnitY().dot(straight) * straight).normalized();
  const Vector3d beside = finger + 0.0098 * side;
  const Vector3d axis = (beside - web).normalized();
  const Vector3d lead = beside + 0.034 * axis;
  tool.pointing = axis;
  tool.fixed_tip = lead;
  tool.radius = 0.0012;
  const auto add = [&](double from, double to, double ra, double rb, HandPart part) {
    tool.held.push_back({{lead - from * axis, lead - to * axis, ra, rb}, part, side});
  };
  add(0.165, 0.020, 0.0036, 0.0036, HandPart::kPencil);
  add(0.020, 0.005, 0.0035, 0.0017, HandPart::kPencilWood);
  add(0.006, 0.000, 0.0018, 0.0012, HandPart::kPencilLead);
  return tool;
}

HandTool hand_round_cup() {
  HandGesture grip;
  grip.fingers[0] = {0.04, 0.42, 0.75, 0.35};
  grip.fingers[1] = {0.01, 0.45, 0.75, 0.35};
  grip.fingers[2] = {-0.03, 0.40, 0.75, 0.35};
  grip.fingers[3] = {-0.06, 0.25, 0.50, 0.50};
  grip.thumb = {0.55, 0.72, 0.35, 0.30};
  HandTool tool;
  tool.working = grip;
  tool.passing = flat_gesture();  // no finger is low enough to touch the desk
  tool.tip = HandTool::Tip::kFixed;
  tool.fixed_tip = {0.092, 0.0, -0.0165 - kCupRadius};
  tool.radius = kCupRadius;
  return tool;
}

namespace {

/// Index finger and thumb as far apart as they are round a cup, the other fingers bent.
HandGesture gesture_over_cup() {
  const double apart = 2.0 * kCupRadius + index_tip_radius() + thumb_tip_radius();
  double narrow = 0.0;  // shares of the wide pinch
  double wide = 1.0;
  HandGesture gesture;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (narrow + wide);
    gesture = blend(pinching_gesture(), wide_pinch_gesture(), middle);
    const double gap = (index_tip_in_wrist(gesture) - thumb_tip_in_wrist(gesture)).norm();
    (gap < apart ? narrow : wide) = middle;
  }
  const HandGesture bent = pointing_gesture();
  for (std::size_t f = 1; f < 4; ++f) gesture.fingers[f] = bent.fingers[f];
  return gesture;
}

/// Axes in the wrist frame of a hand that holds a cup by its rim, as columns: the level direction
/// in which the hand points, the level one to its left, and up.
Eigen::Matrix3d level_axes_over_cup(const HandGesture& gesture) {
  // The line between both fingertips is level. About that line the hand is tilted so that thumb and
  // index finger point down about equally; it then points 33 degrees below the horizontal.
  constexpr double kTilt = 40.0 * kDegree;
  const Vector3d across = (index_tip_in_wrist(gesture) - thumb_tip_in_wrist(gesture)).normalized();
  const Vector3d pointing = (Vector3d::UnitX() - across.x() * across).normalized();
  const Vector3d palm = pointing.cross(across).normalized();
  const Vector3d up = -(std::cos(kTilt) * pointing + std::sin(kTilt) * palm);
  Eigen::Matrix3d axes;
  axes.col(0) = (Vector3d::UnitX() - up.x() * up).normalized();
  axes.col(1) = up.cross(axes.col(0));
  axes.col(2) = up;
  return axes;
}

}  // namespace

HandTool hand_over_cup() {
  HandTool tool;
  tool.working = tool.passing = gesture_over_cup();
  tool.tip = HandTool::Tip::kFixed;
  const Vector3d thumb = thumb_tip_in_wrist(tool.working);
  const Vector3d across = (index_tip_in_wrist(tool.working) - thumb).normalized();
  tool.fixed_tip = thumb + (kCupRadius + thumb_tip_radius()) * across;
  tool.radius = kCupRadius;
  tool.pointing = -level_axes_over_cup(tool.working).col(2);
  return tool;
}

Rigid3 wrist_from_held_cup(double handle) {
  const HandTool tool = hand_over_cup();
  const Eigen::Matrix3d level = level_axes_over_cup(tool.working);
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = level * Eigen::AngleAxisd(handle, Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = tool.fixed_tip - kRimGripHeight * level.col(2);
  return pose;
}

Eigen::Quaterniond turn_over_cup(const Vector3d& pointing) {
  Eigen::Matrix3d desk_from_level;
  desk_from_level.col(0) = pointing;
  desk_from_level.col(1) = Vector3d::UnitZ().cross(pointing);
  desk_from_level.col(2) = Vector3d::UnitZ();
  return Eigen::Quaterniond(desk_from_level *
                            level_axes_over_cup(hand_over_cup().working).transpose());
}

std::vector<HandCapsule> cup_capsules(const Rigid3& desk_from_cup) {
  std::vector<HandCapsule> capsules;
  const auto add = [&](const Vector3d& a, const Vector3d& b, double radius) {
    capsules.push_back({{desk_from_cup * a, desk_from_cup * b, radius, radius},
                        HandPart::kCup,
                        desk_from_cup.linear() * Vector3d::UnitX()});
  };
  const double r = kCupWallRadius;
  for (int i = 0; i < kCupStaves; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / kCupStaves;
    const Vector3d out = (kCupRadius - r) * Vector3d(std::cos(turn), std::sin(turn), 0.0);
    add(out + r * Vector3d::UnitZ(), out + (kCupHeight - r) * Vector3d::UnitZ(), r);
  }
  // The axis of the handle is half an ellipse.
  const auto handle = [](int i) {
    const double t = std::numbers::pi * (static_cast<double>(i) / kCupHandleParts - 0.5);
    return Vector3d(kCupRadius - 0.003 + 0.030 * std::cos(t), 0.0, 0.050 + 0.026 * std::sin(t));
  };
  for (int i = 0; i < kCupHandleParts; ++i) add(handle(i), handle(i + 1), 0.0055);
  return capsules;
}

}  // namespace palpable
