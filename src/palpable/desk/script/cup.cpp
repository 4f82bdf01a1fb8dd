#include "palpable/desk/script/cup.h"

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/camera_motions.h"
#include "palpable/desk/script/contact_truth.h"
#include "palpable/desk/script/cup_push.h"
#include "palpable/desk/script/press_targets.h"
#include "palpable/desk/script/random.h"
#include "palpable/desk/script/things.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kStands = 0.0005;  // m, gap between the desk and the bottom of the cup
constexpr double kRunUp = 0.10;     // m, distance that the cup is pushed before it touches
constexpr double kPushFrame = 44;   // frame of the hand's motion at which the push begins
constexpr double kWidestView = 68.0 * kDegree;  // docs/benchmark.md states 70 degrees

/// Random choices of a sequence.
struct CupChoice {
  double depth;      // m
  double first_yaw;  // rad, first rotation of the body that is tried
  double in;         // duration of the push, frames
};

CupChoice cup_choice(std::uint64_t seed) {
  Random random(seed, "cup");
  CupChoice choice{};
  choice.depth = random.between(0.0035, 0.0065);
  choice.first_yaw = random.between(0.0, 2.0 * std::numbers::pi);
  choice.in = random.between(24.0, 44.0);
  return choice;
}

Rigid3 cup_pose(const Vector3d& origin, const Vector3d& direction) {
  // The handle points backwards and to the thumb's side, where it touches neither body nor palm.
  const Vector3d thumb_side = Vector3d::UnitZ().cross(direction);
  const Vector3d handle = (-0.34 * direction + 0.94 * thumb_side).normalized();
  Rigid3 pose = Rigid3::Identity();
  pose.linear().col(0) = handle;
  pose.linear().col(1) = Vector3d::UnitZ().cross(handle);
  pose.linear().col(2) = Vector3d::UnitZ();
  pose.translation() = origin;
  return pose;
}

/// The motion: a hand brings the cup, pushes it against the body, releases it and leaves.
struct CupWay {
  HandPath hand;  // its tip is on the cup's axis, kGripHeight above the bottom
  Vector3d direction;
  double let_go;  // frame from which the cup stands still

  [[nodiscard]] Movers movers(double frame) const {
    Movers all;
    if (frame < kFramesWithoutHand) return all;
    // The cup stands on the desk, so it follows the planned hand without the tremor.
    const HandPose held = hand.planned(std::min(frame, let_go));
    const Vector3d tip = held.desk_from_wrist * hand.tool.fixed_tip;
    all.desk_from_cup = cup_pose(tip - kGripHeight * Vector3d::UnitZ(), direction);
    if (frame < hand.keys.back().frame) all.capsules = hand.capsules(frame);
    const std::vector<HandCapsule> cup = cup_capsules(*all.desk_from_cup);
    all.capsules.insert(all.capsules.end(), cup.begin(), cup.end());
    return all;
  }
};

CupWay cup_way(const CupPush& push, const CupChoice& choice, std::uint64_t seed) {
  const Vector3d& h = push.direction;
  const double in = choice.in;
  // The palm faces along the push.
  const Quaterniond grip(frame_of(h.cross(Vector3d::UnitZ()), -h));
  const Vector3d touch = push.at_touch + kGripHeight * Vector3d::UnitZ();
  const Vector3d deepest = touch + choice.depth * h;
  const Vector3d put_down = touch - kRunUp * h;
  CupWay way;
  way.hand.tool = hand_round_cup();
  way.hand.tremor_seed = seed;
  way.direction = h;
  way.let_go = kFramesWithoutHand + 50 + in;
  const auto key = [&](double at, const Vector3d& tip, double open) {
    way.hand.keys.push_back({kFramesWithoutHand + at, tip, grip, open});
  };
  key(0, put_down + Vector3d(0.45, 0.10, 0.16), 0.0);
  key(26, put_down + Vector3d(0.05, 0.01, 0.05), 0.0);
  key(38, put_down, 0.0);
  key(kPushFrame, put_down, 0.0);
  key(kPushFrame + in, deepest, 0.0);
  key(50 + in, deepest, 0.0);
  key(60 + in, deepest - 0.004 * h, 1.0);
  key(76 + in, deepest - 0.14 * h + Vector3d(0.0, 0.0, 0.05), 1.0);
  key(104 + in, deepest + Vector3d(0.50, 0.05, 0.22), 0.8);
  return way;
}

/// Describes an unplanned contact: the hand touches body or desk, or the cup touches the body
/// before the push. Empty when there is none.
std::string trouble_on(const CupWay& way, const Eigen::Matrix3Xd& body) {
  for (int frame = kFramesWithoutHand; frame < way.hand.keys.back().frame; ++frame) {
    const std::vector<Capsule> hand = shapes_of(way.hand.capsules(frame));
    const bool on_desk = lowest_point(hand) <= 0.0;
    if (on_desk || touches(hand, body))
      return fmt::format("in frame {} the hand would meet the {}", frame,
                         on_desk ? "desk" : "body");
    if (frame < kFramesWithoutHand + kPushFrame &&
        touches(shapes_of(way.movers(frame).capsules), body))
      return "the cup would meet the body on its way";
  }
  return "";
}

Sequence sequence_of(const CupWay& way, const CupPush& push, const CupChoice& choice,
                     const DeskBody& body, const Rigid3& desk_from_body, int frames,
                     std::uint64_t seed) {
  Sequence sequence = tripod_sequence("cup", frames, seed);
  sequence.desk_from_body = desk_from_body;
  sequence.movers = [way](double frame) { return way.movers(frame); };
  PlannedTouch touch;
  touch.what = "cup";
  touch.site = nearest_site(body, desk_from_body.inverse() * push.touched);
  touch.depth = choice.depth;
  touch.frames = {static_cast<int>(kFramesWithoutHand + kPushFrame), frames - 1};
  touch.seconds_to_depth = choice.in / kFramesPerSecond;
  touch.view_angle = view_angle_of_push(push, first_eye());
  touch.first_touch = push.at_touch;
  touch.direction = push.direction;
  if (touch.frames.first < frames) sequence.touches = {touch};
  const NamedSpan let_go{"let_go", {static_cast<int>(std::ceil(way.let_go)), frames - 1}};
  if (let_go.frames.first < frames) sequence.spans = {let_go};
  return sequence;
}

}  // namespace

Sequence plan_cup(const DeskBody& body, int frames, std::uint64_t seed) {
  const CupChoice choice = cup_choice(seed);
  const SurfacePoints surface = sample_surface(body.surface, 0.002);
  std::string why = "no way on which the camera sees the touching side";

  for (int turn = 0; turn < 9; ++turn) {
    const Rigid3 desk_from_body = turned_body(choice.first_yaw + 40.0 * turn * kDegree);
    const SurfacePoints points = transformed(surface, desk_from_body);
    for (const double azimuth : {222.0, 230.0, 214.0, 238.0})
      for (const double aside : {0.0, 0.015, -0.015}) {
        const Vector3d h(std::cos(azimuth * kDegree), std::sin(azimuth * kDegree), 0.0);
        const auto push = find_cup_push(points.points, h, aside, kStands);
        if (!push || view_angle_of_push(*push, first_eye()) > kWidestView) continue;
        const CupWay way = cup_way(*push, choice, seed);
        const std::string trouble = trouble_on(way, points.points);
        if (trouble.empty())
          return sequence_of(way, *push, choice, body, desk_from_body, frames, seed);
        why = trouble;
      }
  }
  throw Error(
      fmt::format("the sequence 'cup' cannot be planned for this body: {}; the body should be "
                  "0.05 to 0.25 m high and stand round the axis of its frame",
                  why));
}

}  // namespace palpable
