// The sequences in which a thing is turned before the camera and then presses with a side that the
// camera saw before.

#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/contact_truth.h"
#include "palpable/desk/script/plan_sequence.h"
#include "palpable/desk/script/seen_share.h"
#include "palpable/desk/script/things.h"
#include "tests/support/desk_egg.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

using namespace palpable;
using palpable::test::desk_egg;
using palpable::test::tolerance;

namespace {

std::vector<Capsule> movers_at(const Sequence& s, int frame) {
  return shapes_of(s.movers(frame).capsules);
}

/// Desk from thing: of the cup, else of the first capsule of the pencil.
Rigid3 thing_at(const Sequence& s, int frame) {
  const Movers movers = s.movers(frame);
  if (movers.desk_from_cup) return *movers.desk_from_cup;
  for (const HandCapsule& c : movers.capsules) {
    if (c.part != HandPart::kPencil) continue;
    Rigid3 pose = Rigid3::Identity();
    pose.linear() = frame_of(c.shape.b - c.shape.a, c.back);
    pose.translation() = c.shape.a;
    return pose;
  }
  FAIL("there is no thing in frame " << frame);
  return Rigid3::Identity();
}

/// The share of points (3 x P, desk) that the camera sees in a frame.
double seen_in(const Sequence& s, int frame, const Eigen::Matrix3Xd& points) {
  const RectifiedStereo eyes{zed_mini_rig().left.pinhole, 0.063};
  const Rigid3 camera_from_desk = s.camera_from_desk(frame);
  return seen_share(camera_from_desk * points, transformed(movers_at(s, frame), camera_from_desk),
                    eyes);
}

/// The share of points (3 x P, in the thing's frame) that the camera sees at any time of a span.
double seen_during(const Sequence& s, const FrameSpan& span, const Eigen::Matrix3Xd& in_thing) {
  int seen = 0;
  for (Eigen::Index i = 0; i < in_thing.cols(); ++i) {
    for (int frame = span.first; frame <= span.last; frame += 6) {
      if (seen_in(s, frame, thing_at(s, frame) * in_thing.col(i)) == 0.0) continue;
      ++seen;
      break;
    }
  }
  return static_cast<double>(seen) / static_cast<double>(in_thing.cols());
}

/// By what angle the thing turns in a span, rad: the sum over its frames. May exceed pi.
double turned_in(const Sequence& s, const FrameSpan& span) {
  double sum = 0.0;
  for (int frame = span.first; frame < span.last; ++frame)
    sum +=
        Eigen::AngleAxisd(thing_at(s, frame + 1).linear() * thing_at(s, frame).linear().transpose())
            .angle();
  return sum;
}

struct Deepest {
  int frame = -1;
  double depth = 0;  // m
};

Deepest deepest_in(const Sequence& s, const FrameSpan& span, const SurfacePoints& in_desk) {
  Deepest deepest;
  for (int frame = span.first; frame <= span.last; ++frame) {
    const PressTruth truth = press_truth(movers_at(s, frame), in_desk);
    if (truth.touching && truth.depth > deepest.depth) deepest = {frame, truth.depth};
  }
  return deepest;
}

}  // namespace

TEST_CASE("a thing is turned in view and then presses with a side that was seen",
          "[script][long]") {
  const DeskBody body = desk_egg();
  const SurfaceDistance surface(body.surface);
  for (const char* name : {"cup-turn", "pencil-turn"})
    for (const std::uint64_t seed : {1U, 2U}) {
      INFO(name << ", seed " << seed);
      const Sequence s = plan_sequence(name, body, 600, seed);
      const SurfacePoints in_desk =
          transformed(sample_surface(body.surface, 0.0015), s.desk_from_body);
      REQUIRE(s.touches.size() >= 2);
      REQUIRE(s.spans.size() >= s.touches.size());
      for (std::size_t i = 0; i < s.touches.size(); ++i) {
        const PlannedTouch& touch = s.touches[i];
        const FrameSpan turned = s.spans[i].frames;
        INFO("touch " << i << ", turned in frames " << turned.first << " to " << turned.last);
        CHECK(s.spans[i].name == "turned");
        CHECK(turned.last - turned.first >= 45);  // 1.5 s
        CHECK(turned.last - turned.first <= 90);  // 3 s
        CHECK(turned_in(s, turned) > 179.0 * kDegree);
        CHECK(turned.last < touch.frames.first);
        CHECK(touch.view_angle > 90.0 * kDegree);
        if (touch.frames.last >= s.frames) continue;  // cut by the end
        const Deepest deepest = deepest_in(s, touch.frames, in_desk);
        REQUIRE(deepest.frame >= 0);
        CHECK(deepest.depth > 0.5 * touch.depth);
        // The side is seen again only after this press: the memory of 3 s has to hold it.
        CHECK(deepest.frame - turned.last < 90);
        const Rigid3 body_from_desk = s.desk_from_body.inverse();
        const Eigen::Matrix3Xd part =
            s.desk_from_body *
            touching_part(transformed(movers_at(s, deepest.frame), body_from_desk), surface, 0.0015,
                          60);
        REQUIRE(part.cols() > 0);
        CHECK(seen_in(s, deepest.frame, part) <= 0.6);
        CHECK(seen_during(s, turned, thing_at(s, deepest.frame).inverse() * part) > 0.8);
      }
      for (int frame = kFramesWithoutHand; frame < s.frames; frame += 3) {
        const bool planned = std::any_of(s.touches.begin(), s.touches.end(), [&](const auto& t) {
          return t.frames.first <= frame && frame <= t.frames.last;
        });
        INFO("frame " << frame);
        if (!planned) CHECK_FALSE(touches(movers_at(s, frame), in_desk.points));
      }
    }
}

TEST_CASE("a turned cup stays upright in the hand, its handle away from the body", "[script]") {
  const DeskBody body = desk_egg();
  const Sequence s = plan_sequence("cup-turn", body, 240, 3);
  const Rigid3 at_first = thing_at(s, kFramesWithoutHand);
  // The wrist is where the first bone of the palm begins, up to a constant offset.
  constexpr std::size_t kPalmBone = 15;
  const auto root = [&](int frame) {
    return Eigen::Vector3d(thing_at(s, frame).inverse() *
                           s.movers(frame).capsules[kPalmBone].shape.a);
  };
  for (int frame = kFramesWithoutHand; frame < s.frames; frame += 5) {
    INFO("frame " << frame);
    CHECK((thing_at(s, frame).linear().col(2) - Eigen::Vector3d::UnitZ()).norm() <=
          tolerance(1e-9, "products of rotations"));
    CHECK((root(frame) - root(kFramesWithoutHand)).norm() <=
          tolerance(1e-9, "the cup follows the hand rigidly"));
    for (const Capsule& c : movers_at(s, frame)) CHECK(std::min(c.a.z(), c.b.z()) > 0.0);
  }
  CHECK(at_first.translation().x() > 0.3);  // it comes from the right
  REQUIRE_FALSE(s.touches.empty());
  const Eigen::Vector3d handle = thing_at(s, s.touches[0].frames.last).linear().col(0);
  CHECK(handle.dot(s.touches[0].direction) < -0.8);
}

TEST_CASE("finger and thumb of the hand over a cup lie at its rim", "[script]") {
  const HandTool tool = hand_over_cup();
  HandPose pose;
  pose.gesture = tool.working;
  const Rigid3 cup_from_wrist = wrist_from_held_cup(0.0).inverse();
  const std::vector<HandCapsule> hand = hand_capsules(pose);
  for (const int tip : {kIndexTip, kThumbTip}) {
    const Capsule& bone = hand[static_cast<std::size_t>(tip)].shape;
    const Eigen::Vector3d at = cup_from_wrist * bone.b;
    CHECK(std::abs(at.head<2>().norm() - (kCupRadius + bone.rb)) <= tolerance(1e-6, "bisection"));
    CHECK(std::abs(at.z() - kRimGripHeight) <= tolerance(1e-6, "the line between them is level"));
  }
  // The rest of the hand is above the rim.
  for (std::size_t i = 0; i < hand.size(); ++i) {
    if (i <= kIndexTip || (i >= 12 && i <= kThumbTip)) continue;
    if (hand[i].part == HandPart::kForearm || hand[i].part == HandPart::kSleeve) continue;
    INFO("capsule " << i);
    CHECK((cup_from_wrist * hand[i].shape.a).z() - hand[i].shape.ra > kCupHeight);
    CHECK((cup_from_wrist * hand[i].shape.b).z() - hand[i].shape.rb > kCupHeight);
  }
  // turn_over_cup() holds the cup upright.
  const Eigen::Quaterniond turn = turn_over_cup(Eigen::Vector3d::UnitY());
  const Eigen::Matrix3d desk_from_cup = turn * wrist_from_held_cup(0.0).linear();
  CHECK((desk_from_cup.col(2) - Eigen::Vector3d::UnitZ()).norm() <= tolerance(1e-12, "rotations"));
  CHECK((desk_from_cup.col(0) - Eigen::Vector3d::UnitY()).norm() <= tolerance(1e-12, "rotations"));
}

TEST_CASE("a spin turns a hand by more than half a turn about a pivot that stays", "[script]") {
  HandPath path;
  path.tool = hand_with_pencil();
  const Eigen::Vector3d pivot(0.085, 0.0, 0.0);
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  const Eigen::Quaterniond before(frame_of({-1, 0, 0}, {0, 0, 1}));
  const double angle = 200.0 * kDegree;
  const auto tip_at = [&](const Eigen::Quaterniond& turn) {
    return Eigen::Vector3d(Eigen::Vector3d(0.1, -0.2, 0.3) + turn * (path.tool.fixed_tip - pivot));
  };
  const Eigen::Quaterniond after = Eigen::AngleAxisd(angle, axis) * before;
  path.keys = {{10, tip_at(before), before, 0.0},
               {14, tip_at(before), before, 0.0},
               {74, tip_at(after), after, 0.0, {angle, axis, pivot}},
               {78, tip_at(after), after, 0.0}};
  double sum = 0.0;
  for (int frame = 10; frame < 78; ++frame) {
    const Rigid3 now = path.planned(frame).desk_from_wrist;
    const Rigid3 next = path.planned(frame + 1).desk_from_wrist;
    CHECK((now * pivot - Eigen::Vector3d(0.1, -0.2, 0.3)).norm() <= tolerance(1e-12, "rounding"));
    const Eigen::AngleAxisd step(next.linear() * now.linear().transpose());
    sum += step.angle();
    if (step.angle() > 1e-6) CHECK(step.axis().dot(axis) > 0.999);
    CHECK(step.angle() < 0.1);  // 200 degrees in 60 frames, at most 1.5 times as fast as on average
  }
  CHECK(std::abs(sum - angle) <= tolerance(1e-6, "the sum of 68 angles"));
  CHECK((path.planned(78).desk_from_wrist.linear() - after.toRotationMatrix()).norm() <=
        tolerance(1e-9, "rounding"));
}
