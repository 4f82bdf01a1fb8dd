/// @file
/// How a hand moves: places of its tip at some moments and a smooth way between them.
///
/// Desk frame (desk_body.h), metres; moments are frame numbers and need not be whole.
#pragma once

#include "palpable/synth/hand.h"

#include <cstdint>
#include <vector>

namespace palpable {

/// What of a hand touches, and how the hand is held meanwhile. All in the wrist frame (hand.h).
struct HandTool {
  HandGesture working;  ///< while it touches
  HandGesture passing;  ///< while it only passes
  enum class Tip { kIndexFinger, kFixed } tip = Tip::kIndexFinger;
  Eigen::Vector3d fixed_tip = Eigen::Vector3d::Zero();  ///< of Tip::kFixed: middle of what touches
  Eigen::Vector3d pointing = Eigen::Vector3d::UnitX();  ///< unit: where tool or finger points
  double radius = 0;                                    ///< m, of the touching tip's sphere
  std::vector<HandCapsule> held;                        ///< what the hand holds, in the wrist frame
};

/// The index finger of a pointing hand; open where it passes.
[[nodiscard]] HandTool index_finger();
/// The middle of an open hand's fingers, palm forward.
[[nodiscard]] HandTool flat_hand();

/// Where the tip is in the wrist frame.
[[nodiscard]] Eigen::Vector3d tip_in_wrist(const HandTool& tool, const HandGesture& gesture);

/// Where the arm comes from: directions in the desk frame, away from the hand.
struct ArmSide {
  Eigen::Vector3d elbow = Eigen::Vector3d(0.85, 0.30, 0.40);
  Eigen::Vector3d shoulder = Eigen::Vector3d(0.85, 0.20, 0.45);
};

/// The hand whose tip is at a place, turned like `turn` (desk from wrist).
[[nodiscard]] HandPose pose_at_tip(const HandTool& tool, const Eigen::Vector3d& tip,
                                   const Eigen::Quaterniond& turn, const HandGesture& gesture,
                                   const ArmSide& arm);

/// All that such a pose consists of: hand_capsules and what the hand holds, in the desk frame.
[[nodiscard]] std::vector<HandCapsule> capsules_of(const HandTool& tool, const HandPose& pose);

/// Rotation whose first column is `x` and whose third is as near to `z_hint` as can be.
[[nodiscard]] Eigen::Matrix3d frame_of(const Eigen::Vector3d& x, const Eigen::Vector3d& z_hint);

/// Turns the wrist so that the tool points along `pointing` and the back of the hand looks towards
/// `back` as well as it can.
[[nodiscard]] Eigen::Quaterniond turn_for(const HandTool& tool, const Eigen::Vector3d& pointing,
                                          const Eigen::Vector3d& back);

/// The hand at one moment.
struct HandKey {
  double frame = 0;
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();             ///< desk frame
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< desk from wrist
  double open = 0;                                           ///< 0 working, 1 passing
};

/// Between keys positions follow a monotone cubic, so no key is overshot: a press ends where it was
/// planned and a straight approach is straight.
struct HandPath {
  HandTool tool;
  ArmSide arm;
  std::vector<HandKey> keys;  ///< at least two, increasing frames; before and after: at rest there
  std::uint64_t tremor_seed = 0;

  /// As planned, without tremor.
  [[nodiscard]] HandPose planned(double frame) const;
  /// With it: a living hand trembles, three sines an axis, together below 0.2 mm.
  [[nodiscard]] HandPose pose(double frame) const;
  [[nodiscard]] std::vector<HandCapsule> capsules(double frame) const;
};

/// The other hand: everything mirrored at the plane X = 0 of the desk.
[[nodiscard]] std::vector<HandCapsule> mirrored(std::vector<HandCapsule> capsules);

}  // namespace palpable
