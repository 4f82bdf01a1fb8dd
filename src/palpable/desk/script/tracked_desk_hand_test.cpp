#include "palpable/common/geometry/tracked_hand.h"
#include "palpable/desk/script/hand.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

// The joints that a tracker would find in a hand of the synthetic desk, in WebXR's order. The roots
// of the fingers' bones are ends of the capsules behind the fingers'.
struct Found {
  std::vector<Vector3d> joints;
  std::vector<double> radii;
  void add(const Vector3d& place, double radius) {
    joints.push_back(place);
    radii.push_back(radius);
  }
};

Found found_in(const std::vector<HandCapsule>& hand) {
  const auto bone = [&](std::size_t k) -> const Capsule& { return hand[k].shape; };
  Found found;
  found.add(0.5 * (bone(25).a + bone(25).b), 0.018);  // the wrist's capsule
  found.add(bone(12).a, bone(12).ra);
  for (std::size_t k = 12; k < 15; ++k) found.add(bone(k).b, bone(k).rb);
  for (std::size_t f = 0; f < 4; ++f) {
    found.add(bone(15 + f).a, bone(15 + f).ra);
    found.add(bone(3 * f).a, bone(3 * f).ra);
    for (std::size_t k = 3 * f; k < 3 * f + 3; ++k) found.add(bone(k).b, bone(k).rb);
  }
  return found;
}

// Points all over the surface of a capsule: rings about its axis, and six points of each end's
// ball.
std::vector<Vector3d> surface_of(const Capsule& c) {
  std::vector<Vector3d> points;
  for (const int axis : {0, 1, 2}) {
    for (const double sign : {-1.0, 1.0}) {
      points.emplace_back(c.a + sign * c.ra * Vector3d::Unit(axis));
      points.emplace_back(c.b + sign * c.rb * Vector3d::Unit(axis));
    }
  }
  const double length = (c.b - c.a).norm(), sine = length > 0 ? (c.ra - c.rb) / length : 1;
  if (!(std::abs(sine) < 1)) return points;  // a ball
  const double cosine = std::sqrt(1 - sine * sine);
  const Vector3d along = (c.b - c.a) / length, u = along.unitOrthogonal(), v = along.cross(u);
  constexpr int kRings = 7, kAround = 8;
  for (int i = 0; i < kRings; ++i) {
    const double t = i / (kRings - 1.0), radius = c.ra + t * (c.rb - c.ra);
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAround;
      const Vector3d around = std::cos(angle) * u + std::sin(angle) * v;
      points.emplace_back(c.a + t * (c.b - c.a) + radius * (sine * along + cosine * around));
    }
  }
  return points;
}

// m: how far points all over one hand's surface are from the other's, at most.
template <class Hand, class Other>
double farthest(const Hand& hand, const Other& other) {
  double most = 0;
  int used = 0;
  for (const Capsule& capsule : hand) {
    for (const Vector3d& at : surface_of(capsule)) {
      if (std::abs(signed_distance(hand, at)) > 1e-9) continue;  // inside of another capsule
      most = std::max(most, std::abs(signed_distance(other, at)));
      ++used;
    }
  }
  REQUIRE(used > 300);
  return most;
}

TEST_CASE("the joints of a desk's hand give its surface back", "[script][hands]") {
  for (const HandGesture& gesture :
       {pointing_gesture(), open_gesture(), flat_gesture(), pinching_gesture()}) {
    HandPose pose;
    pose.gesture = gesture;
    const std::vector<HandCapsule> hand = hand_capsules(pose);
    const Found found = found_in(hand);
    std::vector<Capsule> surface = shapes_of(std::span(hand).first(26));  // without the arm
    const TrackedHand given = value_or_throw(
        tracked_hand(HandLayout::kWebXr, HandSide::kRight, found.joints, found.radii));
    const TrackedHand mean =
        value_or_throw(tracked_hand(HandLayout::kWebXr, HandSide::kRight, found.joints));
    for (const TrackedHand& tracked : {given, mean}) {
      CHECK(farthest(surface, tracked) < tolerance(0.003, "m: the bar of issue 60"));
      CHECK(farthest(tracked, surface) < 0.003);
    }
  }
}

}  // namespace
}  // namespace palpable
