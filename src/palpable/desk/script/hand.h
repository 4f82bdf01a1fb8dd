/// @file
/// A right hand with its arm: joints, bones, and the capsules that form its surface.
///
/// Wrist frame: origin in the wrist, X towards the fingers, Y towards the thumb, Z out of the back
/// of the hand; m and rad.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"

#include <array>
#include <vector>

namespace palpable {

/// Joint angles of one finger. 0 is straight, a positive angle bends towards the palm.
struct FingerAngles {
  double spread = 0;  ///< at the knuckle, positive towards the thumb
  double knuckle = 0;
  double middle = 0;
  double tip = 0;
};

/// Joint angles of the thumb.
struct ThumbAngles {
  double opening = 0.6;   ///< in the plane of the palm, away from the index finger
  double opposing = 0.5;  ///< out of that plane, towards the palm
  double middle = 0.2;
  double tip = 0.2;
};

/// All joints. The fingers are index, middle, ring, little.
struct HandGesture {
  std::array<FingerAngles, 4> fingers;
  ThumbAngles thumb;
};

[[nodiscard]] HandGesture pointing_gesture();  ///< index straight, the others closed
[[nodiscard]] HandGesture open_gesture();      ///< all nearly straight and spread
[[nodiscard]] HandGesture flat_gesture();      ///< all straight and side by side
/// Thumb and index finger opposite to each other, with the centres of their tips 24 mm apart (or
/// 112 mm for the wide pinch); the other fingers are straight. In blends of the two gestures, the
/// direction between the tips changes by less than 10 degrees.
[[nodiscard]] HandGesture pinching_gesture();
[[nodiscard]] HandGesture wide_pinch_gesture();
/// Interpolates all angles between two gestures: `share` 0 gives the first, 1 the second.
[[nodiscard]] HandGesture blend(const HandGesture& first, const HandGesture& second, double share);

/// A hand with its arm.
struct HandPose {
  Rigid3 desk_from_wrist = Rigid3::Identity();
  HandGesture gesture;
  Eigen::Vector3d elbow = Eigen::Vector3d(-0.25, 0, 0);      ///< in the desk frame
  Eigen::Vector3d shoulder = Eigen::Vector3d(-0.5, 0, 0.1);  ///< in the desk frame
};

/// The part to which a capsule belongs, which determines how it is painted. The last four are parts
/// of things that a hand holds (things.h).
enum class HandPart {
  kPalm,
  kBone,
  kFingerTip,
  kForearm,
  kSleeve,
  kPencil,
  kPencilWood,
  kPencilLead,
  kCup
};

/// A capsule with the data needed to paint it.
struct HandCapsule {
  Capsule shape;
  HandPart part = HandPart::kPalm;
  /// Unit, towards the back of the hand, where the nails are.
  Eigen::Vector3d back = Eigen::Vector3d::UnitZ();
};

/// The number of capsules of a hand, and the index of the last bone of the index finger. End b of
/// that capsule is the centre of the finger tip's sphere.
inline constexpr int kHandCapsuleCount = 30;
inline constexpr int kIndexTip = 2;
inline constexpr int kThumbTip = 14;  ///< the same for the thumb

/// The capsules of a hand in the desk frame; always kHandCapsuleCount, in the same order.
[[nodiscard]] std::vector<HandCapsule> hand_capsules(const HandPose& pose);

/// The capsule in another frame.
[[nodiscard]] HandCapsule transformed(HandCapsule capsule, const Rigid3& target_from_source);

/// The capsules without their paint data.
[[nodiscard]] std::vector<Capsule> shapes_of(std::span<const HandCapsule> hand);

/// Centre of the index finger tip's sphere in the wrist frame.
[[nodiscard]] Eigen::Vector3d index_tip_in_wrist(const HandGesture& gesture);

/// Centre of the thumb tip's sphere in the wrist frame.
[[nodiscard]] Eigen::Vector3d thumb_tip_in_wrist(const HandGesture& gesture);

/// Direction of the index finger's last bone in the wrist frame, unit.
[[nodiscard]] Eigen::Vector3d index_direction_in_wrist(const HandGesture& gesture);

/// Radius of the index finger's tip, m.
[[nodiscard]] double index_tip_radius();
[[nodiscard]] double thumb_tip_radius();  ///< m

}  // namespace palpable
