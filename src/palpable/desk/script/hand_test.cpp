#include "palpable/desk/script/hand.h"

#include "tests/support/test.h"

#include <cmath>

using namespace palpable;
using palpable::test::random_case;
using palpable::test::tolerance;

namespace {

HandPose some_pose(unsigned seed) {
  auto random = random_case(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  HandPose pose;
  pose.gesture = blend(pointing_gesture(), open_gesture(), uniform(random));
  for (FingerAngles& finger : pose.gesture.fingers) finger.middle = 1.5 * uniform(random);
  pose.gesture.thumb.tip = uniform(random);
  const Eigen::Vector3d axis(uniform(random), uniform(random), 0.1 + uniform(random));
  pose.desk_from_wrist.linear() =
      Eigen::AngleAxisd(6.0 * uniform(random), axis.normalized()).toRotationMatrix();
  pose.desk_from_wrist.translation() << uniform(random), uniform(random), uniform(random);
  pose.elbow = pose.desk_from_wrist * Eigen::Vector3d(-0.25, 0.02, 0.03);
  pose.shoulder = pose.elbow + Eigen::Vector3d(0.1, 0.2, 0.2);
  return pose;
}

}  // namespace

TEST_CASE("a hand with its arm has thirty capsules in every pose", "[script]") {
  STATIC_REQUIRE(kHandCapsuleCount >= 16);
  for (unsigned seed = 0; seed < 5; ++seed)
    CHECK(hand_capsules(some_pose(seed)).size() == kHandCapsuleCount);
}

TEST_CASE("bones keep their lengths and radii in every gesture and place", "[script]") {
  const std::vector<HandCapsule> rest = hand_capsules(HandPose{});
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    const std::vector<HandCapsule> moved = hand_capsules(some_pose(seed));
    for (std::size_t i = 0; i < moved.size(); ++i) {
      if (moved[i].part == HandPart::kForearm || moved[i].part == HandPart::kSleeve) continue;
      INFO("capsule " << i);
      CHECK(std::abs((moved[i].shape.b - moved[i].shape.a).norm() -
                     (rest[i].shape.b - rest[i].shape.a).norm()) <=
            tolerance(1e-14, "four rotations of 0.1 m"));
      CHECK(moved[i].shape.ra == rest[i].shape.ra);
      CHECK(moved[i].shape.rb == rest[i].shape.rb);
    }
  }
}

TEST_CASE("the bones of a finger hang together, with one radius at each joint", "[script]") {
  const std::vector<HandCapsule> hand = hand_capsules(some_pose(3));
  for (std::size_t finger = 0; finger < 5; ++finger)
    for (std::size_t bone = 0; bone < 2; ++bone) {
      const Capsule& first = hand[3 * finger + bone].shape;
      const Capsule& second = hand[3 * finger + bone + 1].shape;
      CHECK(first.b == second.a);
      CHECK(first.rb == second.ra);
    }
}

TEST_CASE("the index finger's tip is where its last capsule ends", "[script]") {
  const HandPose pose = some_pose(7);
  const std::vector<HandCapsule> hand = hand_capsules(pose);
  const Capsule& tip = hand[kIndexTip].shape;
  CHECK(hand[kIndexTip].part == HandPart::kFingerTip);
  CHECK((pose.desk_from_wrist * index_tip_in_wrist(pose.gesture) - tip.b).norm() <=
        tolerance(1e-15, "the same sums"));
  CHECK(tip.rb == index_tip_radius());
  const Eigen::Vector3d direction =
      pose.desk_from_wrist.linear() * index_direction_in_wrist(pose.gesture);
  CHECK((direction - (tip.b - tip.a).normalized()).norm() <= tolerance(1e-13, "a 17 mm bone"));
}

TEST_CASE("a bent finger closes towards the palm", "[script]") {
  HandGesture bent = open_gesture();
  bent.fingers[0].middle += 0.8;
  CHECK(index_tip_in_wrist(bent).z() < index_tip_in_wrist(open_gesture()).z() - 0.01);
}

TEST_CASE("a blend begins with the first gesture and ends with the second", "[script]") {
  const HandGesture a = pointing_gesture();
  const HandGesture b = open_gesture();
  CHECK(index_tip_in_wrist(blend(a, b, 0.0)) == index_tip_in_wrist(a));
  CHECK((index_tip_in_wrist(blend(a, b, 1.0)) - index_tip_in_wrist(b)).norm() <=
        tolerance(1e-15, "a + (b - a)"));
}
