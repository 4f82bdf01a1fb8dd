#include "palpable/desk/script/cup_turn.h"

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/camera_motions.h"
#include "palpable/desk/script/contact_truth.h"
#include "palpable/desk/script/cup_push.h"
#include "palpable/desk/script/press_search.h"
#include "palpable/desk/script/press_targets.h"
#include "palpable/desk/script/random.h"
#include "palpable/desk/script/things.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kHeldAbove = 0.006;  // m, height of the cup's bottom while it is pushed
constexpr double kPushFrom = 0.06;    // m, distance that the cup is pushed before it touches
constexpr double kFromEye = 0.10;     // m, smallest distance of hand and cup from the eye
constexpr double kUnseenFrom = 105.0 * kDegree;  // view angle; cup_turn.h states it
constexpr double kSeenUpTo = 75.0 * kDegree;     // view angle before the turn; as well
constexpr std::array<double, 2> kAngles = {180.0 * kDegree, 200.0 * kDegree};  // of a turn
const Vector3d kInView(0.09, -0.13, 0.03);  // bottom of the cup while it turns, right of the body

/// Random choices of a whole sequence.
struct HeldCupChoice {
  double first_yaw;  // rad, first rotation of the body that is tried
  double handle;     // rad, see wrist_from_held_cup()
  double away;       // degrees, azimuth of the push that is tried first; 90 leads away from the eye
};

/// Random choices of one turn with its push; durations in frames. From the middle of a turn, when
/// the camera last sees the side that will touch, to the end of the push it takes less than 3 s.
struct CupTurnChoice {
  double angle, turn;      // rad and duration of the turn
  double depth, in, hold;  // m, duration of the push, duration at the full depth
  double back;             // duration of the turn back
};

HeldCupChoice held_cup_choice(std::uint64_t seed) {
  Random random(seed, "cup-turn");
  HeldCupChoice choice{};
  choice.first_yaw = random.between(0.0, 2.0 * std::numbers::pi);
  choice.handle = random.between(-110.0, -90.0) * kDegree;
  choice.away = random.between(70.0, 110.0);
  return choice;
}

CupTurnChoice cup_turn_choice(std::uint64_t seed, int number) {
  Random random(seed, fmt::format("cup-turn {}", number));
  CupTurnChoice choice{};
  choice.angle = random.between(kAngles[0], kAngles[1]);
  choice.turn = random.between(48.0, 66.0);
  choice.depth = random.between(0.0045, 0.0070);
  choice.in = random.between(12.0, 22.0);
  choice.hold = random.between(10.0, 18.0);
  choice.back = random.between(36.0, 48.0);
  return choice;
}

/// The motion of hand and cup, and its pushes.
struct CupTurnWay {
  HandPath hand;  // its tip is on the cup's axis, kRimGripHeight above the bottom
  Rigid3 wrist_from_cup = Rigid3::Identity();
  std::vector<PlannedTouch> touches;
  std::vector<NamedSpan> turns;

  [[nodiscard]] Movers movers(double frame) const {
    Movers all;
    if (frame < kFramesWithoutHand) return all;
    const HandPose pose = hand.pose(frame);
    all.desk_from_cup = pose.desk_from_wrist * wrist_from_cup;
    all.capsules = capsules_of(hand.tool, pose);
    const std::vector<HandCapsule> cup = cup_capsules(*all.desk_from_cup);
    all.capsules.insert(all.capsules.end(), cup.begin(), cup.end());
    return all;
  }
};

/// Writes the keys of a CupTurnWay one after the other.
class CupTurnScript {
 public:
  CupTurnScript(const CupPush& push, double handle, int site, std::uint64_t seed)
      : push_(push), site_(site), seed_(seed) {
    way_.hand.tool = hand_over_cup();
    way_.hand.tremor_seed = seed;
    way_.wrist_from_cup = wrist_from_held_cup(handle);
    // The bent fingers are on the camera's side, where the body is not.
    pushing_ = turn_over_cup(push.direction.cross(Vector3d::UnitZ()));
  }

  /// Adds turns with their pushes until the script has this many frames, at least one of them.
  CupTurnWay write(int frames) {
    CupTurnChoice now = cup_turn_choice(seed_, 0);
    Quaterniond turn = before(now);
    key(0, kInView + Vector3d(0.45, 0.10, 0.16), turn);
    key(26, kInView, turn);
    key(6, kInView, turn);
    for (int number = 1; number == 1 || at_ < frames; ++number) {
      turn_and_push(now);
      now = cup_turn_choice(seed_, number);
      spin(now.back, before(now), -now.angle);
      key(6, kInView, before(now));
    }
    return way_;
  }

 private:
  /// The orientation from which a turn leads to that of the push. Turns are counter-clockwise as
  /// seen from above, so that the arm passes behind the cup and not before the camera.
  [[nodiscard]] Quaterniond before(const CupTurnChoice& choice) const {
    return Eigen::AngleAxisd(-choice.angle, Vector3d::UnitZ()) * pushing_;
  }

  void key(double later, const Vector3d& bottom, const Quaterniond& turn) {
    at_ += later;
    way_.hand.keys.push_back({at_, bottom + kRimGripHeight * Vector3d::UnitZ(), turn, 0.0});
  }

  void spin(double later, const Quaterniond& turn, double angle) {
    key(later, kInView, turn);
    way_.hand.keys.back().spin = {angle, Vector3d::UnitZ(), way_.hand.tool.fixed_tip};
  }

  void turn_and_push(const CupTurnChoice& choice) {
    const Vector3d start = push_.at_touch - kPushFrom * push_.direction;
    const Vector3d deepest = push_.at_touch + choice.depth * push_.direction;
    const double turned = at_;
    spin(choice.turn, pushing_, choice.angle);
    way_.turns.push_back({"turned", whole_frames(turned, at_)});
    key(3, kInView, pushing_);
    key(12, start, pushing_);
    PlannedTouch touch;
    touch.what = "cup";
    touch.site = site_;
    touch.depth = choice.depth;
    touch.seconds_to_depth = choice.in / kFramesPerSecond;
    touch.view_angle = view_angle_of_push(push_, first_eye());
    touch.first_touch = push_.at_touch;
    touch.direction = push_.direction;
    const double begins = at_;
    key(choice.in, deepest, pushing_);
    key(choice.hold, deepest, pushing_);
    key(12, start, pushing_);
    touch.frames = whole_frames(begins, at_);
    way_.touches.push_back(touch);
    key(12, kInView, pushing_);
  }

  static FrameSpan whole_frames(double first, double last) {
    return {static_cast<int>(std::floor(first)), static_cast<int>(std::ceil(last))};
  }

  const CupPush& push_;
  int site_;
  std::uint64_t seed_;
  Quaterniond pushing_ = Quaterniond::Identity();  // orientation of the hand during pushes
  double at_ = kFramesWithoutHand;                 // frame of the last key
  CupTurnWay way_;
};

/// Describes an unplanned contact: hand or cup touches the desk, the hand touches the body, or the
/// cup does outside of its pushes, or one of them comes too near to the eye. Empty when there is
/// none.
std::string trouble_with(const CupTurnWay& way, const Eigen::Matrix3Xd& body) {
  for (int frame = kFramesWithoutHand; frame < way.hand.keys.back().frame; ++frame) {
    const std::vector<Capsule> all = shapes_of(way.movers(frame).capsules);
    const std::span<const Capsule> hand(all.data(), kHandCapsuleCount);
    if (lowest_point(all) <= 0.0)
      return fmt::format("in frame {} hand or cup would meet the desk", frame);
    if (signed_distance(all, first_eye()) < kFromEye)
      return fmt::format("in frame {} hand or cup would come too near to the camera", frame);
    const bool pushes = std::any_of(
        way.touches.begin(), way.touches.end(),
        [&](const PlannedTouch& t) { return t.frames.first <= frame && frame <= t.frames.last; });
    if (touches(pushes ? hand : std::span<const Capsule>(all), body))
      return fmt::format("in frame {} the {} would meet the body", frame,
                         pushes ? "hand" : "hand or cup");
  }
  return "";
}

/// A rotation of the body and a push that are free of trouble, or the reason why there is none.
struct CupTurnPlan {
  CupTurnWay way;
  Rigid3 desk_from_body = Rigid3::Identity();
  std::string why_not = "no way away from the camera on which the cup meets the body";
};

/// Whether the camera sees the side that will touch before a turn, and does not see it while it
/// touches.
bool shows_then_hides(const CupPush& push) {
  if (view_angle_of_push(push, first_eye()) < kUnseenFrom) return false;
  return std::all_of(kAngles.begin(), kAngles.end(), [&](double angle) {
    const Vector3d touched =
        Eigen::AngleAxisd(-angle, Vector3d::UnitZ()) * Vector3d(push.touched - push.at_touch);
    const CupPush before{push.direction, kInView, kInView + touched};
    return view_angle_of_push(before, first_eye()) < kSeenUpTo;
  });
}

CupTurnPlan find_cup_turn(const DeskBody& body, int frames, std::uint64_t seed) {
  const HeldCupChoice choice = held_cup_choice(seed);
  const SurfacePoints surface = sample_surface(body.surface, 0.002);
  CupTurnPlan plan;
  for (int turn = 0; turn < 9; ++turn) {
    plan.desk_from_body = turned_body(choice.first_yaw + 40.0 * turn * kDegree);
    const SurfacePoints points = transformed(surface, plan.desk_from_body);
    for (const double beside : {0.0, 15.0, -15.0, 30.0, -30.0})
      for (const double aside : {0.0, 0.015, -0.015}) {
        const double azimuth = choice.away + beside;
        const Vector3d h(std::cos(azimuth * kDegree), std::sin(azimuth * kDegree), 0.0);
        const auto push = find_cup_push(points.points, h, aside, kHeldAbove);
        if (!push || !shows_then_hides(*push)) continue;
        const int site = nearest_site(body, plan.desk_from_body.inverse() * push->touched);
        plan.way = CupTurnScript(*push, choice.handle, site, seed).write(frames);
        plan.why_not = trouble_with(plan.way, points.points);
        if (plan.why_not.empty()) return plan;
      }
  }
  return plan;
}

}  // namespace

Sequence plan_cup_turn(const DeskBody& body, int frames, std::uint64_t seed) {
  CupTurnPlan plan = find_cup_turn(body, frames, seed);
  if (!plan.why_not.empty()) {
    throw Error(fmt::format(
        "the sequence 'cup-turn' cannot be planned for this body: {}; the body should be 0.05 to "
        "0.25 m high and stand round the axis of its frame",
        plan.why_not));
  }
  Sequence sequence = tripod_sequence("cup-turn", frames, seed);
  sequence.desk_from_body = plan.desk_from_body;
  sequence.touches = plan.way.touches;
  sequence.spans = plan.way.turns;
  std::erase_if(sequence.touches, [&](const PlannedTouch& t) { return t.frames.first >= frames; });
  std::erase_if(sequence.spans, [&](const NamedSpan& s) { return s.frames.first >= frames; });
  sequence.movers = [way = std::move(plan.way)](double frame) { return way.movers(frame); };
  return sequence;
}

}  // namespace palpable
