#include "palpable/desk/script/things.h"

#include "palpable/desk/script/camera_motions.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <cmath>

using namespace palpable;
using palpable::test::tolerance;

TEST_CASE("a pencil is 165 mm long, ends in its tip and lies between thumb and index finger",
          "[script]") {
  const HandTool tool = hand_with_pencil();
  HandPose pose;
  pose.gesture = tool.working;
  const std::vector<HandCapsule> all = capsules_of(tool, pose);
  REQUIRE(all.size() == kHandCapsuleCount + tool.held.size());
  const Capsule& lead = tool.held.back().shape;
  CHECK((lead.b - tool.fixed_tip).norm() <= tolerance(1e-15, "the same point"));
  CHECK(lead.rb == tool.radius);
  CHECK(std::abs((tool.held.front().shape.a - lead.b).norm() - 0.165) <=
        tolerance(1e-12, "along one axis"));
  CHECK(std::abs((lead.b - lead.a).normalized().dot(tool.pointing) - 1.0) <=
        tolerance(1e-12, "along one axis"));
  // Fingers and pencil overlap by no more than skin deforms, and there is no gap.
  const Capsule& wood = tool.held.front().shape;
  const auto gap_to = [&](std::size_t capsule) {
    double least = 1.0;
    for (int i = 0; i <= 200; ++i) {
      const Eigen::Vector3d x = wood.a + i / 200.0 * (lead.b - wood.a);
      least = std::min(least, signed_distance(all[capsule].shape, x) - wood.ra);
    }
    return least;
  };
  CHECK(std::abs(gap_to(kIndexTip)) < 0.003);
  CHECK(gap_to(14) < 0.008);  // the thumb's last bone
}

TEST_CASE("the staves of a cup follow its wall within 0.2 mm", "[script]") {
  Rigid3 pose = Rigid3::Identity();
  pose.translation() << 0.2, 0.1, 0.3;
  const std::vector<HandCapsule> cup = cup_capsules(pose);
  REQUIRE(cup.size() == kCupStaves + kCupHandleParts);
  const std::vector<Capsule> shapes = shapes_of(cup);
  for (int i = 0; i < 77; ++i) {
    // Points on the half without the handle.
    const double turn = 0.5 * 3.14159 + 3.14159 * i / 76.0;
    const Eigen::Vector3d out(std::cos(turn), std::sin(turn), 0.0);
    const double off = signed_distance(
        shapes, pose * Eigen::Vector3d(kCupRadius * out + 0.05 * Eigen::Vector3d::UnitZ()));
    CHECK(off > -1e-12);
    CHECK(off < 0.0002);
  }
}

TEST_CASE("the fingers of the hand round a cup lie on its wall", "[script]") {
  const HandTool tool = hand_round_cup();
  HandPose pose;
  pose.gesture = tool.working;
  const std::vector<HandCapsule> hand = hand_capsules(pose);
  // The bones of three fingers are about the cup's radius plus the finger's radius away from the
  // cup's axis. The little finger is shorter and reaches in.
  for (std::size_t i = 0; i < 9; ++i) {
    const Capsule& bone = hand[i].shape;
    const Eigen::Vector3d to = bone.b - tool.fixed_tip;
    const double from_axis = Eigen::Vector2d(to.x(), to.z()).norm();
    INFO("bone " << i);
    CHECK(from_axis > kCupRadius - 0.002);
    CHECK(from_axis < kCupRadius + 0.016);
  }
}

TEST_CASE("a mirrored hand is the same hand with its sides exchanged", "[script]") {
  HandPose pose;
  pose.desk_from_wrist = Eigen::Translation3d(0.1, 0.2, 0.3) *
                         Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized());
  const std::vector<HandCapsule> right = hand_capsules(pose);
  const std::vector<HandCapsule> left = mirrored(right);
  const Eigen::Vector3d flip(-1, 1, 1);
  for (std::size_t i = 0; i < right.size(); ++i) {
    CHECK(left[i].shape.a == flip.cwiseProduct(right[i].shape.a));
    CHECK(left[i].shape.rb == right[i].shape.rb);
    CHECK(left[i].back == flip.cwiseProduct(right[i].back));
  }
}

TEST_CASE("a path passes through its keys without overshooting", "[script]") {
  HandPath path;
  path.tool = index_finger();
  const auto turn = turn_for(path.tool, {-1, 0, 0}, {0, 0, 1});
  path.keys = {{10, {0.3, 0, 0.1}, turn, 1.0},
               {20, {0.1, 0, 0.1}, turn, 0.0},
               {26, {0.1, 0, 0.1}, turn, 0.0},
               {40, {0.2, 0, 0.2}, turn, 0.5}};
  const auto tip = [&](double frame) {
    const HandPose pose = path.planned(frame);
    return Eigen::Vector3d(pose.desk_from_wrist * tip_in_wrist(path.tool, pose.gesture));
  };
  for (const HandKey& key : path.keys)
    CHECK((tip(key.frame) - key.tip).norm() <= tolerance(1e-12, "rounding"));
  for (double frame = 0; frame < 50; frame += 0.5) {
    CHECK(tip(frame).x() >= 0.1 - 1e-12);
    CHECK((path.pose(frame).desk_from_wrist.translation() -
           path.planned(frame).desk_from_wrist.translation())
              .norm() < 0.0004);
  }
  CHECK((tip(0) - path.keys.front().tip).norm() <= tolerance(1e-12, "at rest before"));
  CHECK((tip(99) - path.keys.back().tip).norm() <= tolerance(1e-12, "and after"));
}
