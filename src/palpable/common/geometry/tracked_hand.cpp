#include "palpable/common/geometry/tracked_hand.h"

#include "palpable/common/base/contract.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

using Eigen::Vector3d;

// MediaPipe gives no joint at the root of a finger's bone in the palm. It is put on the line from
// the wrist to the knuckle, at this ratio of the distance.
constexpr double kRoot = 0.13;

constexpr double kShortest = 0.08, kLongest = 0.30;  // m, a small child's hand and a large one

// A joint and the distance of the skin from it.
struct Joint {
  Vector3d place = Vector3d::Zero();
  double radius = 0;
};

// The joints of every layout, in one order.
struct Skeleton {
  Vector3d wrist = Vector3d::Zero();
  std::array<Joint, 4> thumb;
  std::array<Joint, 4> roots;                   // of the fingers' bones in the palm
  std::array<std::array<Joint, 4>, 4> fingers;  // knuckle ... tip
  double length = 0;                            // m, along the bones of the middle finger
  double scale = 1;                             // to the mean hand
};

// Index of each part's first joint. Thumb and fingers follow one another.
struct Order {
  int wrist, thumb, fingers, to_next, root;  // root: joints of a finger before its knuckle
};

Order order_of(HandLayout layout) {
  switch (layout) {
    case HandLayout::kOpenXr:
      return {1, 2, 6, 5, 1};
    case HandLayout::kWebXr:
      return {0, 1, 5, 5, 1};
    case HandLayout::kMediaPipe:
      break;
  }
  return {0, 1, 5, 4, 0};
}

// m, from the wrist along the bones of the middle finger.
double length_of(const Order& order, std::span<const Vector3d> joints) {
  const auto knuckle = static_cast<std::size_t>(order.fingers + order.to_next + order.root);
  double length = (joints[knuckle] - joints[static_cast<std::size_t>(order.wrist)]).norm();
  for (std::size_t k = knuckle + 1; k < knuckle + 4; ++k) {
    length += (joints[k] - joints[k - 1]).norm();
  }
  return length;
}

// Moves a tip that lies on the skin to the centre of its ball.
void retract(std::array<Joint, 4>& bones) {
  const Vector3d back = (bones[2].place - bones[3].place).normalized();
  if (back.allFinite()) bones[3].place += bones[3].radius * back;
}

Skeleton skeleton_of(HandLayout layout, std::span<const Vector3d> joints,
                     std::span<const double> radii) {
  const Order order = order_of(layout);
  Skeleton hand;
  hand.wrist = joints[static_cast<std::size_t>(order.wrist)];
  hand.length = length_of(order, joints);
  hand.scale = hand.length / kMeanHandLength;
  const auto joint = [&](int index, double mean) -> Joint {
    const auto at = static_cast<std::size_t>(index);
    return {joints[at], radii.empty() ? hand.scale * mean : radii[at]};
  };
  for (int k = 0; k < 4; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const int first = order.fingers + k * order.to_next;
    const std::array<double, 5>& mean = kMeanFingerRadii[at];
    hand.thumb[at] = joint(order.thumb + k, kMeanThumbRadii[at]);
    for (std::size_t j = 0; j < 4; ++j) {
      hand.fingers[at][j] = joint(first + order.root + static_cast<int>(j), mean[j + 1]);
    }
    hand.roots[at] = order.root > 0
                         ? joint(first, mean[0])
                         : Joint{hand.wrist + kRoot * (hand.fingers[at][0].place - hand.wrist),
                                 hand.scale * mean[0]};
  }
  if (layout == HandLayout::kMediaPipe) {
    retract(hand.thumb);
    for (auto& finger : hand.fingers) retract(finger);
  }
  return hand;
}

Vector3d between(const Joint& a, const Joint& b, double share) {
  return a.place + share * (b.place - a.place);
}

// Unit, out of the palm.
Vector3d palm_direction(const Skeleton& hand, HandSide side) {
  const Vector3d forward = hand.fingers[1][0].place - hand.wrist;
  const Vector3d to_thumb = hand.fingers[0][0].place - hand.fingers[3][0].place;
  const Vector3d back = forward.cross(to_thumb).normalized();
  if (!back.allFinite()) return Vector3d::Zero();
  return side == HandSide::kRight ? Vector3d(-back) : back;
}

// The palm beside the four bones: webs between the knuckles, pads of thumb, little finger and
// middle, and the wrist; places and radii are those of desk/script/hand.cpp.
template <class Add>
void add_palm(const Skeleton& hand, HandSide side, const Add& add) {
  const double s = hand.scale;
  const Vector3d palm = s * palm_direction(hand, side);
  const auto& [index, middle, ring, little] = hand.fingers;
  for (std::size_t f = 0; f < 3; ++f) {
    const auto behind = [&](std::size_t k) {
      return Vector3d(between(hand.fingers[k][0], hand.roots[k], 0.18) + 0.0035 * palm);
    };
    add(behind(f), behind(f + 1), 0.0092 * s, 0.0086 * s);
  }
  const auto& roots = hand.roots;
  add(between(roots[0], index[0], 0.1) + 0.010 * palm,
      between(roots[0], index[0], 0.53) + 0.011 * palm, 0.0150 * s, 0.0125 * s);
  add(between(roots[3], little[0], 0.11) + 0.006 * palm,
      between(roots[3], little[0], 0.73) + 0.0055 * palm, 0.0145 * s, 0.0125 * s);
  add(between(roots[1], middle[0], 0.25) + 0.004 * palm,
      0.8 * between(roots[1], middle[0], 0.75) + 0.2 * between(roots[2], ring[0], 0.75) +
          0.005 * palm,
      0.0150 * s, 0.0125 * s);
  Vector3d across = index[0].place - little[0].place;
  across *= 0.011 * s / std::max(across.norm(), 1e-9);
  add(hand.wrist + across, hand.wrist - across, 0.0180 * s, 0.0175 * s);
}

}  // namespace

int joint_count(HandLayout layout) {
  const Order order = order_of(layout);
  return order.fingers + 4 * order.to_next;
}

std::string_view name_of(HandLayout layout) {
  switch (layout) {
    case HandLayout::kOpenXr:
      return "openxr";
    case HandLayout::kWebXr:
      return "webxr";
    case HandLayout::kMediaPipe:
      break;
  }
  return "mediapipe";
}

std::optional<HandLayout> hand_layout_named(std::string_view name) {
  for (const HandLayout layout :
       {HandLayout::kOpenXr, HandLayout::kWebXr, HandLayout::kMediaPipe}) {
    if (name == name_of(layout)) return layout;
  }
  return std::nullopt;
}

std::optional<HandSide> hand_side_named(std::string_view name) {
  if (name == "left") return HandSide::kLeft;
  if (name == "right") return HandSide::kRight;
  return std::nullopt;
}

Result<TrackedHand> tracked_hand(HandLayout layout, HandSide side, std::span<const Vector3d> joints,
                                 std::span<const double> radii) {
  const auto count = static_cast<std::size_t>(joint_count(layout));
  PALPABLE_EXPECT(joints.size() == count && (radii.empty() || radii.size() == count),
                  "as many joints as the layout has");
  for (std::size_t k = 0; k < count; ++k) {
    if (!joints[k].allFinite()) return Problem{fmt::format("joint {} is not finite", k)};
    if (!radii.empty() && !(radii[k] >= 0.0005 && radii[k] <= 0.1)) {
      return Problem{
          fmt::format("the radius of joint {} is {} m, not 0.5 mm to 100 mm", k, radii[k])};
    }
  }
  const Skeleton hand = skeleton_of(layout, joints, radii);
  if (!(hand.length >= kShortest && hand.length <= kLongest)) {
    return Problem{fmt::format(
        "the hand is {:.4g} m long from the wrist to the tip of the middle finger, not 0.08 to "
        "0.3: are its joints in metres?",
        hand.length)};
  }
  TrackedHand capsules;
  std::size_t next = 0;
  const auto add = [&](const Vector3d& a, const Vector3d& b, double ra, double rb) {
    capsules[next++] = {a, b, ra, rb};
  };
  const auto add_bone = [&](const Joint& a, const Joint& b) {
    add(a.place, b.place, a.radius, b.radius);
  };
  for (std::size_t k = 0; k < 3; ++k) add_bone(hand.thumb[k], hand.thumb[k + 1]);
  for (const auto& finger : hand.fingers) {
    for (std::size_t k = 0; k < 3; ++k) add_bone(finger[k], finger[k + 1]);
  }
  for (std::size_t f = 0; f < 4; ++f) add_bone(hand.roots[f], hand.fingers[f][0]);
  add_palm(hand, side, add);
  PALPABLE_EXPECT(next == capsules.size(), "the count is documented");
  return capsules;
}

}  // namespace palpable
