#include "palpable/desk/script/hand.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/tracked_hand.h"

#include <algorithm>
#include <cstddef>

namespace palpable {

namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

/// Sizes of an adult's hand (about 185 mm from the wrist to the tip of the middle finger), m.
struct FingerShape {
  Vector3d root;                  ///< start of the bone in the palm, wrist frame
  Vector3d knuckle;               ///< wrist frame
  std::array<double, 3> lengths;  ///< bones beyond the knuckle; the last ends in the tip's sphere
};

// clang-format off
const std::array<FingerShape, 4> kFingers = {{
    {{0.012,  0.013, 0.000}, {0.088,  0.0235, 0.000}, {0.044, 0.026, 0.0175}},
    {{0.010,  0.004, 0.001}, {0.090,  0.0030, 0.002}, {0.048, 0.030, 0.0185}},
    {{0.010, -0.006, 0.000}, {0.084, -0.0165, 0.000}, {0.045, 0.028, 0.0185}},
    {{0.011, -0.015, -0.002}, {0.075, -0.0345, -0.004}, {0.036, 0.020, 0.0165}},
}};
// clang-format on

const Vector3d kThumbRoot(0.018, 0.020, -0.008);
constexpr std::array<double, 3> kThumbLengths = {0.046, 0.034, 0.0235};

/// The joints of a chain of bones. Each bone is rotated about the Y axis of the previous bone's
/// frame (X along the bone, Z towards its back); a positive angle bends towards the palm.
struct Chain {
  std::array<Vector3d, 4> joints;
  Vector3d direction;  ///< of the last bone
  Vector3d back;       ///< of the last bone
};

Chain bend(const Vector3d& start, Eigen::Matrix3d frame, const std::array<double, 3>& lengths,
           const std::array<double, 3>& angles) {
  Chain chain;
  chain.joints[0] = start;
  for (std::size_t i = 0; i < 3; ++i) {
    frame = frame * AngleAxisd(angles[i], Vector3d::UnitY()).toRotationMatrix();
    chain.joints[i + 1] = chain.joints[i] + lengths[i] * frame.col(0);
  }
  chain.direction = frame.col(0);
  chain.back = frame.col(2);
  return chain;
}

Chain finger_chain(const FingerShape& shape, const FingerAngles& angles) {
  const Eigen::Matrix3d spread = AngleAxisd(angles.spread, Vector3d::UnitZ()).toRotationMatrix();
  return bend(shape.knuckle, spread, shape.lengths, {angles.knuckle, angles.middle, angles.tip});
}

Chain thumb_chain(const ThumbAngles& angles) {
  // The frame of the thumb is rotated about its own axis, so that its nail faces away from the
  // fingers.
  const Eigen::Matrix3d frame =
      (AngleAxisd(angles.opening, Vector3d::UnitZ()) *
       AngleAxisd(angles.opposing, Vector3d::UnitY()) * AngleAxisd(-0.9, Vector3d::UnitX()))
          .toRotationMatrix();
  return bend(kThumbRoot, frame, kThumbLengths, {0.0, angles.middle, angles.tip});
}

}  // namespace

HandGesture pointing_gesture() {
  HandGesture g;
  g.fingers[0] = {0.02, 0.22, 0.34, 0.20};
  g.fingers[1] = {0.00, 1.05, 1.45, 0.75};
  g.fingers[2] = {0.00, 1.15, 1.50, 0.80};
  g.fingers[3] = {-0.02, 1.20, 1.45, 0.80};
  g.thumb = {0.45, 0.75, 0.55, 0.65};
  return g;
}

HandGesture open_gesture() {
  HandGesture g;
  g.fingers[0] = {0.14, 0.18, 0.22, 0.12};
  g.fingers[1] = {0.02, 0.20, 0.24, 0.14};
  g.fingers[2] = {-0.10, 0.24, 0.26, 0.14};
  g.fingers[3] = {-0.24, 0.28, 0.28, 0.16};
  g.thumb = {0.85, 0.35, 0.15, 0.15};
  return g;
}

HandGesture flat_gesture() {
  HandGesture g;
  g.fingers[0] = {0.03, 0.06, 0.06, 0.04};
  g.fingers[1] = {0.00, 0.07, 0.06, 0.04};
  g.fingers[2] = {-0.03, 0.07, 0.06, 0.04};
  g.fingers[3] = {-0.08, 0.08, 0.08, 0.05};
  g.thumb = {0.55, 0.25, 0.15, 0.10};
  return g;
}

HandGesture pinching_gesture() {
  HandGesture g;
  g.fingers[0] = {0.11, 0.53, 1.07, 0.53};
  g.fingers[1] = {0.00, 0.12, 0.20, 0.12};
  g.fingers[2] = {-0.08, 0.10, 0.18, 0.12};
  g.fingers[3] = {-0.18, 0.10, 0.18, 0.12};
  g.thumb = {0.43, 0.50, 0.18, 0.14};
  return g;
}

HandGesture wide_pinch_gesture() {
  HandGesture g = pinching_gesture();
  g.fingers[0] = {-0.10, 0.33, 0.60, 0.35};
  g.thumb = {1.04, 0.40, 0.04, 0.24};
  return g;
}

HandGesture blend(const HandGesture& first, const HandGesture& second, double share) {
  const auto mix = [share](double a, double b) { return a + share * (b - a); };
  HandGesture g;
  for (std::size_t i = 0; i < 4; ++i) {
    const FingerAngles& p = first.fingers[i];
    const FingerAngles& q = second.fingers[i];
    g.fingers[i] = {mix(p.spread, q.spread), mix(p.knuckle, q.knuckle), mix(p.middle, q.middle),
                    mix(p.tip, q.tip)};
  }
  const ThumbAngles& p = first.thumb;
  const ThumbAngles& q = second.thumb;
  g.thumb = {mix(p.opening, q.opening), mix(p.opposing, q.opposing), mix(p.middle, q.middle),
             mix(p.tip, q.tip)};
  return g;
}

std::vector<HandCapsule> hand_capsules(const HandPose& pose) {
  std::vector<HandCapsule> hand;
  hand.reserve(kHandCapsuleCount);
  const Rigid3& T = pose.desk_from_wrist;
  const auto add = [&](const Vector3d& a, const Vector3d& b, double ra, double rb, HandPart part,
                       const Vector3d& back) {
    hand.push_back({{T * a, T * b, ra, rb}, part, T.linear() * back});
  };

  // The fingers come first, with three bones each; kIndexTip and kThumbTip depend on this order.
  for (std::size_t f = 0; f < 4; ++f) {
    const std::array<double, 5>& radii = kMeanFingerRadii[f];
    const Chain chain = finger_chain(kFingers[f], pose.gesture.fingers[f]);
    for (std::size_t i = 0; i < 3; ++i)
      add(chain.joints[i], chain.joints[i + 1], radii[i + 1], radii[i + 2],
          i == 2 ? HandPart::kFingerTip : HandPart::kBone, chain.back);
  }
  const Chain thumb = thumb_chain(pose.gesture.thumb);
  for (std::size_t i = 0; i < 3; ++i)
    add(thumb.joints[i], thumb.joints[i + 1], kMeanThumbRadii[i], kMeanThumbRadii[i + 1],
        i == 2 ? HandPart::kFingerTip : HandPart::kBone, thumb.back);

  // Palm: the four bones, webs between the knuckles, the pads and the wrist.
  const Vector3d up = Vector3d::UnitZ();
  for (std::size_t f = 0; f < 4; ++f)
    add(kFingers[f].root, kFingers[f].knuckle, kMeanFingerRadii[f][0], kMeanFingerRadii[f][1],
        HandPart::kPalm, up);
  for (std::size_t f = 0; f < 3; ++f)
    add(kFingers[f].knuckle - Vector3d(0.014, 0, 0.0035),
        kFingers[f + 1].knuckle - Vector3d(0.014, 0, 0.0035), 0.0092, 0.0086, HandPart::kPalm, up);
  add(Vector3d(0.020, 0.016, -0.010), Vector3d(0.052, 0.022, -0.011), 0.0150, 0.0125,
      HandPart::kPalm, up);
  add(Vector3d(0.018, -0.018, -0.008), Vector3d(0.058, -0.027, -0.009), 0.0145, 0.0125,
      HandPart::kPalm, up);
  add(Vector3d(0.030, 0.004, -0.003), Vector3d(0.070, 0.000, -0.003), 0.0150, 0.0125,
      HandPart::kPalm, up);
  add(Vector3d(0.000, 0.011, 0.000), Vector3d(0.000, -0.011, 0.000), 0.0180, 0.0175,
      HandPart::kPalm, up);

  // Forearm: two bones side by side, which make the wrist flat; then the sleeve and the upper arm.
  const Vector3d wrist = T.translation();
  const Vector3d across = T.linear() * Vector3d::UnitY();
  const Vector3d back = T.linear() * up;
  const Vector3d middle = wrist + 0.55 * (pose.elbow - wrist);
  const auto add_in_desk = [&](const Vector3d& a, const Vector3d& b, double ra, double rb,
                               HandPart part) {
    hand.push_back({{a, b, ra, rb}, part, back});
  };
  add_in_desk(wrist + 0.010 * across, middle + 0.009 * across, 0.0185, 0.0290, HandPart::kForearm);
  add_in_desk(wrist - 0.010 * across, middle - 0.009 * across, 0.0180, 0.0285, HandPart::kForearm);
  add_in_desk(wrist + 0.40 * (pose.elbow - wrist), pose.elbow, 0.0420, 0.0500, HandPart::kSleeve);
  add_in_desk(pose.elbow, pose.shoulder, 0.0500, 0.0580, HandPart::kSleeve);
  PALPABLE_EXPECT(static_cast<int>(hand.size()) == kHandCapsuleCount, "the count is documented");
  return hand;
}

HandCapsule transformed(HandCapsule capsule, const Rigid3& target_from_source) {
  capsule.shape = transformed(capsule.shape, target_from_source);
  capsule.back = target_from_source.linear() * capsule.back;
  return capsule;
}

std::vector<Capsule> shapes_of(std::span<const HandCapsule> hand) {
  std::vector<Capsule> shapes;
  shapes.reserve(hand.size());
  for (const HandCapsule& capsule : hand) shapes.push_back(capsule.shape);
  return shapes;
}

Vector3d index_tip_in_wrist(const HandGesture& gesture) {
  return finger_chain(kFingers[0], gesture.fingers[0]).joints[3];
}

Vector3d index_direction_in_wrist(const HandGesture& gesture) {
  return finger_chain(kFingers[0], gesture.fingers[0]).direction;
}

double index_tip_radius() { return kMeanFingerRadii[0][4]; }

Vector3d thumb_tip_in_wrist(const HandGesture& gesture) {
  return thumb_chain(gesture.thumb).joints[3];
}

double thumb_tip_radius() { return kMeanThumbRadii[3]; }

}  // namespace palpable
