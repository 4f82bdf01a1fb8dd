/// @file
/// How a hand moves: where its tip is at some moments (keys), and a smooth path through these.
///
/// Desk frame (desk_body.h), metres; moments are frame numbers and need not be whole.
#pragma once

#include "palpable/desk/script/hand.h"

#include <cstdint>
#include <vector>

namespace palpable {

/// The part of a hand, or of a thing in it, that touches (the tip), and the gestures of the hand.
/// All in the wrist frame (hand.h).
struct HandTool {
  HandGesture working;  ///< of a hand that touches
  HandGesture passing;  ///< of a hand on its way
  enum class Tip { kIndexFinger, kFixed, kPinch } tip = Tip::kIndexFinger;
  Eigen::Vector3d fixed_tip = Eigen::Vector3d::Zero();  ///< of Tip::kFixed: middle of what touches
  Eigen::Vector3d pointing = Eigen::Vector3d::UnitX();  ///< unit: where tool or finger points
  double radius = 0;                                    ///< m, of the touching tip's sphere
  std::vector<HandCapsule> held;                        ///< what the hand holds, in the wrist frame
};

/// The index finger of a pointing hand; on its way the hand is open.
[[nodiscard]] HandTool index_finger();
/// Thumb and index finger of a hand that pinches; the tip is the middle between their tips.
[[nodiscard]] HandTool pinching_hand();
/// A flat hand that presses with the pads between the first joints of index and middle finger.
[[nodiscard]] HandTool flat_hand();

/// Where the tip is in the wrist frame.
[[nodiscard]] Eigen::Vector3d tip_in_wrist(const HandTool& tool, const HandGesture& gesture);

/// Where the arm comes from: directions in the desk frame, away from the hand.
struct ArmSide {
  Eigen::Vector3d elbow = Eigen::Vector3d(0.85, 0.30, 0.40);
  Eigen::Vector3d shoulder = Eigen::Vector3d(0.85, 0.20, 0.45);
};

/// The pose of a hand whose tip is at a place.
/// @param tip   desk frame
/// @param turn  desk from wrist
[[nodiscard]] HandPose pose_at_tip(const HandTool& tool, const Eigen::Vector3d& tip,
                                   const Eigen::Quaterniond& turn, const HandGesture& gesture,
                                   const ArmSide& arm);

/// The capsules of the hand and then of what it holds, in the desk frame.
[[nodiscard]] std::vector<HandCapsule> capsules_of(const HandTool& tool, const HandPose& pose);

/// The rotation whose first column is the direction `x` and whose third is as near to `z_hint` as
/// it can be.
[[nodiscard]] Eigen::Matrix3d frame_of(const Eigen::Vector3d& x, const Eigen::Vector3d& z_hint);

/// The rotation, desk from wrist, with which the tool points along `pointing` and the back of the
/// hand faces `back` as nearly as it can.
[[nodiscard]] Eigen::Quaterniond turn_for(const HandTool& tool, const Eigen::Vector3d& pointing,
                                          const Eigen::Vector3d& back);

/// The hand at one moment.
struct HandKey {
  double frame = 0;
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();             ///< desk frame
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< desk from wrist
  double open = 0;                                           ///< 0 working, 1 passing
};

/// Between keys each coordinate of the tip follows a monotone cubic. It overshoots no key, so a
/// press is exactly as deep as planned, and it keeps a straight approach straight.
struct HandPath {
  HandTool tool;
  ArmSide arm;
  std::vector<HandKey>
      keys;  ///< at least two, by increasing frame; the hand rests before and after
  std::uint64_t tremor_seed = 0;

  /// As planned, without tremor.
  [[nodiscard]] HandPose planned(double frame) const;
  /// With the tremor of a living hand: three sines on each axis, together less than 0.2 mm.
  [[nodiscard]] HandPose pose(double frame) const;
  [[nodiscard]] std::vector<HandCapsule> capsules(double frame) const;
};

/// Mirrored at the plane X = 0 of the desk: a right hand becomes a left one.
[[nodiscard]] std::vector<HandCapsule> mirrored(std::vector<HandCapsule> capsules);

}  // namespace palpable
