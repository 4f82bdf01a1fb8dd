/// @file
/// The motion of a hand: positions of its tip at certain times (keys), and a smooth path through
/// them.
///
/// Desk frame (desk_body.h), m; times are in frames and need not be whole.
#pragma once

#include "palpable/desk/script/hand.h"

#include <cstdint>
#include <vector>

namespace palpable {

/// The part of a hand, or of a thing it holds, that touches the body (the tip), and the gestures of
/// the hand. Wrist frame (hand.h).
struct HandTool {
  HandGesture working;  ///< while the hand touches
  HandGesture passing;  ///< while it moves elsewhere
  enum class Tip { kIndexFinger, kFixed, kPinch } tip = Tip::kIndexFinger;
  Eigen::Vector3d fixed_tip = Eigen::Vector3d::Zero();  ///< centre of the tip, for Tip::kFixed
  Eigen::Vector3d pointing = Eigen::Vector3d::UnitX();  ///< unit, along the tool or finger
  double radius = 0;                                    ///< m, of the tip's sphere
  std::vector<HandCapsule> held;                        ///< capsules of the thing in the hand
};

/// The index finger of a pointing hand. Between touches the hand is open.
[[nodiscard]] HandTool index_finger();
/// Thumb and index finger of a pinching hand. The tip is the point midway between their tips.
[[nodiscard]] HandTool pinching_hand();
/// A flat hand that presses with the pads between the first joints of index and middle finger.
[[nodiscard]] HandTool flat_hand();

/// The position of the tip in the wrist frame.
[[nodiscard]] Eigen::Vector3d tip_in_wrist(const HandTool& tool, const HandGesture& gesture);

/// The direction from which the arm comes: directions in the desk frame, away from the hand.
struct ArmSide {
  Eigen::Vector3d elbow = Eigen::Vector3d(0.85, 0.30, 0.40);
  Eigen::Vector3d shoulder = Eigen::Vector3d(0.85, 0.20, 0.45);
};

/// The pose of a hand with its tip at a given position.
/// @param tip   position, desk frame
/// @param turn  rotation, desk from wrist
[[nodiscard]] HandPose pose_at_tip(const HandTool& tool, const Eigen::Vector3d& tip,
                                   const Eigen::Quaterniond& turn, const HandGesture& gesture,
                                   const ArmSide& arm);

/// The capsules of the hand, then those of the thing it holds, in the desk frame.
[[nodiscard]] std::vector<HandCapsule> capsules_of(const HandTool& tool, const HandPose& pose);

/// The rotation whose first column is the direction `x` and whose third column is as near to
/// `z_hint` as possible.
[[nodiscard]] Eigen::Matrix3d frame_of(const Eigen::Vector3d& x, const Eigen::Vector3d& z_hint);

/// The rotation, desk from wrist, for which the tool points along `pointing` and the back of the
/// hand faces `back` as nearly as possible.
[[nodiscard]] Eigen::Quaterniond turn_for(const HandTool& tool, const Eigen::Vector3d& pointing,
                                          const Eigen::Vector3d& back);

/// A rotation about a given axis on the way from one key to the next. It may exceed half a turn,
/// which the shortest rotation between two orientations cannot.
struct HandSpin {
  double angle = 0;                                 ///< rad, right-handed; 0: no such rotation
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< unit, desk frame
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  ///< wrist frame
};

/// The hand at one time.
struct HandKey {
  double frame = 0;
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();             ///< desk frame
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< desk from wrist
  double open = 0;                                           ///< gesture: 0 working, 1 passing
  /// The rotation from the previous key to this one. With an angle other than 0, `turn` must be
  /// that rotation times the previous key's `turn`.
  HandSpin spin = {};
};

/// The path of a hand. Between keys each coordinate of the tip follows a monotone cubic, which does
/// not overshoot: a press is exactly as deep as planned, and a straight approach stays straight. On
/// the way to a key with a spin the pivot moves straight instead, and the tip round it.
struct HandPath {
  HandTool tool;
  ArmSide arm;
  /// At least two, by increasing frame. The hand rests before the first and after the last.
  std::vector<HandKey> keys;
  std::uint64_t tremor_seed = 0;

  /// The pose without tremor.
  [[nodiscard]] HandPose planned(double frame) const;
  /// The pose with the tremor of a human hand: three sines along each axis, less than 0.2 mm per
  /// axis.
  [[nodiscard]] HandPose pose(double frame) const;
  [[nodiscard]] std::vector<HandCapsule> capsules(double frame) const;
};

/// The capsules mirrored at the plane X = 0 of the desk: a right hand becomes a left one.
[[nodiscard]] std::vector<HandCapsule> mirrored(std::vector<HandCapsule> capsules);

}  // namespace palpable
