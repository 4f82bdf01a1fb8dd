#include "palpable/desk/script/hand_path.h"

#include "palpable/common/base/contract.h"
#include "palpable/desk/script/random.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpable {

using Eigen::Quaterniond;
using Eigen::Vector3d;

HandTool index_finger() {
  HandTool tool;
  tool.working = pointing_gesture();
  tool.passing = open_gesture();
  tool.pointing = index_direction_in_wrist(tool.working);
  tool.radius = index_tip_radius();
  return tool;
}

HandTool pinching_hand() {
  HandTool tool;
  tool.working = pinching_gesture();
  tool.passing = wide_pinch_gesture();
  tool.tip = HandTool::Tip::kPinch;
  tool.pointing = index_direction_in_wrist(tool.working);
  tool.radius = index_tip_radius();
  return tool;
}

HandTool flat_hand() {
  HandTool tool;
  tool.working = flat_gesture();
  tool.passing = open_gesture();
  tool.tip = HandTool::Tip::kFixed;
  // Between the first joints of index and middle finger; their pads are one radius below.
  tool.fixed_tip = {0.115, 0.012, -0.002};
  tool.radius = 0.0105;
  return tool;
}

Vector3d tip_in_wrist(const HandTool& tool, const HandGesture& gesture) {
  switch (tool.tip) {
    case HandTool::Tip::kIndexFinger:
      return index_tip_in_wrist(gesture);
    case HandTool::Tip::kPinch:
      return 0.5 * (index_tip_in_wrist(gesture) + thumb_tip_in_wrist(gesture));
    case HandTool::Tip::kFixed:
      break;
  }
  return tool.fixed_tip;
}

HandPose pose_at_tip(const HandTool& tool, const Vector3d& tip, const Quaterniond& turn,
                     const HandGesture& gesture, const ArmSide& arm) {
  HandPose pose;
  pose.gesture = gesture;
  pose.desk_from_wrist.linear() = turn.toRotationMatrix();
  pose.desk_from_wrist.translation() = tip - turn * tip_in_wrist(tool, gesture);
  // The direction of the forearm is a mean of the hand's own direction (65 %) and that from which
  // the arm comes (35 %). The wrist bends accordingly.
  const Vector3d wrist = pose.desk_from_wrist.translation();
  const Vector3d straight = -(turn * Vector3d::UnitX());
  pose.elbow = wrist + 0.25 * (0.65 * straight + 0.35 * arm.elbow.normalized()).normalized();
  pose.shoulder = pose.elbow + 0.32 * arm.shoulder.normalized();
  return pose;
}

std::vector<HandCapsule> capsules_of(const HandTool& tool, const HandPose& pose) {
  std::vector<HandCapsule> capsules = hand_capsules(pose);
  for (const HandCapsule& held : tool.held)
    capsules.push_back(transformed(held, pose.desk_from_wrist));
  return capsules;
}

Eigen::Matrix3d frame_of(const Vector3d& x, const Vector3d& z_hint) {
  Eigen::Matrix3d R;
  R.col(0) = x.normalized();
  R.col(2) = (z_hint - z_hint.dot(R.col(0)) * R.col(0)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

Quaterniond turn_for(const HandTool& tool, const Vector3d& pointing, const Vector3d& back) {
  const Eigen::Matrix3d local = frame_of(tool.pointing, Vector3d::UnitZ());
  return Quaterniond(frame_of(pointing, back) * local.transpose());
}

HandPose HandPath::planned(double frame) const {
  PALPABLE_EXPECT(keys.size() >= 2, "a path has a beginning and an end");
  const auto n = static_cast<int>(keys.size());
  int k = 0;
  while (k + 2 < n && keys[k + 1].frame <= frame) ++k;
  const auto key = [this](int i) -> const HandKey& { return keys[i]; };
  const double span = key(k + 1).frame - key(k).frame;
  const double t = std::clamp((frame - key(k).frame) / span, 0.0, 1.0);

  // A monotone cubic (Fritsch and Carlson): the tangent at a key is the harmonic mean of the slopes
  // on both sides, or zero where these differ in sign.
  const auto interpolate = [&](auto value) {
    const auto slope = [&](int i) {
      return (value(key(i + 1)) - value(key(i))) / (key(i + 1).frame - key(i).frame);
    };
    const auto tangent = [&](int i) {
      if (i == 0 || i == n - 1) return 0.0;
      const double before = slope(i - 1);
      const double after = slope(i);
      return before * after <= 0.0 ? 0.0 : 2.0 * before * after / (before + after);
    };
    const double t2 = t * t;
    const double t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * value(key(k)) + (t3 - 2 * t2 + t) * span * tangent(k) +
           (3 * t2 - 2 * t3) * value(key(k + 1)) + (t3 - t2) * span * tangent(k + 1);
  };
  Vector3d tip;
  for (int axis = 0; axis < 3; ++axis)
    tip[axis] = interpolate([axis](const HandKey& at) { return at.tip[axis]; });
  const double open = interpolate([](const HandKey& at) { return at.open; });
  const double eased = t * t * (3.0 - 2.0 * t);
  Quaterniond turn = key(k).turn.slerp(eased, key(k + 1).turn);
  const auto gesture_of = [this](double share) {
    return blend(tool.working, tool.passing, std::clamp(share, 0.0, 1.0));
  };
  const HandGesture gesture = gesture_of(open);
  if (const HandSpin& spin = key(k + 1).spin; spin.angle != 0.0) {
    turn = Eigen::AngleAxisd(eased * spin.angle, spin.axis) * key(k).turn;
    const auto arm_of_pivot = [&](const HandGesture& of) -> Vector3d {
      return spin.pivot - tip_in_wrist(tool, of);
    };
    const auto pivot_at = [&](const HandKey& at) -> Vector3d {
      return at.tip + at.turn * arm_of_pivot(gesture_of(at.open));
    };
    const Vector3d from = pivot_at(key(k));
    tip = from + eased * (pivot_at(key(k + 1)) - from) - turn * arm_of_pivot(gesture);
  }
  return pose_at_tip(tool, tip, turn, gesture, arm);
}

HandPose HandPath::pose(double frame) const {
  HandPose pose = planned(frame);
  Random random(tremor_seed, "tremor");
  Vector3d shift = Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis)
    for (const double hertz : {1.7, 4.1, 8.3}) {
      const double phase = random.between(0.0, 2.0 * std::numbers::pi);
      shift[axis] += 0.00006 * std::sin(2.0 * std::numbers::pi * hertz * frame / 30.0 + phase);
    }
  pose.desk_from_wrist.translation() += shift;
  pose.elbow += shift;
  return pose;
}

std::vector<HandCapsule> HandPath::capsules(double frame) const {
  return capsules_of(tool, pose(frame));
}

std::vector<HandCapsule> mirrored(std::vector<HandCapsule> capsules) {
  for (HandCapsule& c : capsules)
    for (Vector3d* v : {&c.shape.a, &c.shape.b, &c.back}) v->x() = -v->x();
  return capsules;
}

}  // namespace palpable
