#include "palpable/synth/cup.h"

#include "palpable/base/error.h"
#include "palpable/synth/camera_motions.h"
#include "palpable/synth/contact_truth.h"
#include "palpable/synth/press_targets.h"
#include "palpable/synth/random.h"
#include "palpable/synth/things.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace palpable {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kStands = 0.0005;  // m between the desk and a cup that stands on it
constexpr double kRunUp = 0.10;     // m the cup is pushed over the desk before it touches

/// The cup's pushing direction and where its axis is when it touches.
struct Push {
  Vector3d direction;
  Vector3d at_touch;  // the cup's origin
  Vector3d touched;   // point of the body
};

Rigid3 cup_pose(const Vector3d& origin, const Vector3d& direction) {
  // The handle looks back and to the thumb's side, where it meets neither body nor palm.
  const Vector3d thumb_side = Vector3d::UnitZ().cross(direction);
  const Vector3d handle = (-0.34 * direction + 0.94 * thumb_side).normalized();
  Rigid3 pose = Rigid3::Identity();
  pose.linear().col(0) = handle;
  pose.linear().col(1) = Vector3d::UnitZ().cross(handle);
  pose.linear().col(2) = Vector3d::UnitZ();
  pose.translation() = origin;
  return pose;
}

/// The first touch of the cup's side on its way: each point of the body stops the axis a chord
/// before itself.
std::optional<Push> find_push(const Eigen::Matrix3Xd& points, const Vector3d& direction,
                              double aside) {
  const Vector3d across = Vector3d::UnitZ().cross(direction);
  const Vector3d middle = points.rowwise().mean();
  const Vector3d start = Vector3d(middle.x(), middle.y(), kStands) + aside * across;
  std::optional<Push> push;
  double first = 0.0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Vector3d x = points.col(i);
    const double beside = (x - start).dot(across);
    if (std::abs(beside) >= kCupRadius || x.z() > kCupHeight - kCupWallRadius) continue;
    const double stop =
        (x - start).dot(direction) - std::sqrt(kCupRadius * kCupRadius - beside * beside);
    if (push && stop >= first) continue;
    first = stop;
    push = Push{direction, start + stop * direction, x};
  }
  return push;
}

}  // namespace

Sequence plan_cup(const DeskBody& body, int frames, std::uint64_t seed) {
  Random random(seed, "cup");
  const double depth = random.between(0.0035, 0.0065);
  const double first_yaw = random.between(0.0, 2.0 * std::numbers::pi);
  const double in = random.between(24.0, 44.0);  // frames of the push
  const SurfacePoints surface = sample_surface(body.surface, 0.002);
  const Vector3d eye = first_eye();
  const HandTool tool = hand_round_cup();
  std::string why = "no way on which the camera sees the touching side";

  for (int turn = 0; turn < 9; ++turn) {
    const Rigid3 desk_from_body = turned_body(first_yaw + 40.0 * turn * kDegree);
    const SurfacePoints points = transformed(surface, desk_from_body);
    for (const double azimuth : {222.0, 230.0, 214.0, 238.0})
      for (const double aside : {0.0, 0.015, -0.015}) {
        const Vector3d h(std::cos(azimuth * kDegree), std::sin(azimuth * kDegree), 0.0);
        const auto push = find_push(points.points, h, aside);
        if (!push) continue;
        // The cup's surface there looks away from its axis.
        Vector3d normal = push->touched - push->at_touch;
        normal.z() = 0.0;
        normal.normalize();
        const Vector3d to_eye = (eye - push->touched).normalized();
        const double view_angle = std::acos(std::clamp(normal.dot(to_eye), -1.0, 1.0));
        if (view_angle > 68.0 * kDegree) continue;

        // The hand's palm looks along the push; its tip is on the cup's axis.
        const Quaterniond grip(frame_of(h.cross(Vector3d::UnitZ()), -h));
        const Vector3d up = kGripHeight * Vector3d::UnitZ();
        const Vector3d touch = push->at_touch + up;
        const Vector3d deepest = touch + depth * h;
        const Vector3d put_down = touch - kRunUp * h;
        HandPath path;
        path.tool = tool;
        path.tremor_seed = seed;
        const auto key = [&](double at, const Vector3d& tip, double open) {
          path.keys.push_back({kFramesWithoutHand + at, tip, grip, open});
        };
        key(0, put_down + Vector3d(0.45, 0.10, 0.16), 0.0);
        key(26, put_down + Vector3d(0.05, 0.01, 0.05), 0.0);
        key(38, put_down, 0.0);
        key(44, put_down, 0.0);
        key(44 + in, deepest, 0.0);
        key(50 + in, deepest, 0.0);
        key(60 + in, deepest - 0.004 * h, 1.0);
        key(76 + in, deepest - 0.14 * h + Vector3d(0.0, 0.0, 0.05), 1.0);
        key(104 + in, deepest + Vector3d(0.50, 0.05, 0.22), 0.8);
        const double let_go = kFramesWithoutHand + 50 + in;

        const auto movers = [path, let_go, h](double frame) {
          Movers all;
          if (frame < kFramesWithoutHand) return all;
          // The cup follows the planned hand, without its tremor: it stands on the desk.
          const HandPose held = path.planned(std::min(frame, let_go));
          const Vector3d tip = held.desk_from_wrist * path.tool.fixed_tip;
          all.desk_from_cup = cup_pose(tip - kGripHeight * Vector3d::UnitZ(), h);
          if (frame < path.keys.back().frame) all.capsules = path.capsules(frame);
          const std::vector<HandCapsule> cup = cup_capsules(*all.desk_from_cup);
          all.capsules.insert(all.capsules.end(), cup.begin(), cup.end());
          return all;
        };

        // The hand itself meets neither body nor desk, and the cup the body only at the end.
        const double touching = kFramesWithoutHand + 44;
        bool clean = true;
        for (int frame = kFramesWithoutHand; clean && frame < path.keys.back().frame; ++frame) {
          const std::vector<Capsule> hand = shapes_of(path.capsules(frame));
          const bool on_desk = lowest_point(hand) <= 0.0;
          clean = !on_desk && !touches(hand, points.points);
          if (!clean)
            why = fmt::format("in frame {} the hand would meet the {}", frame,
                              on_desk ? "desk" : "body");
          if (clean && frame < touching) {
            clean = !touches(shapes_of(movers(frame).capsules), points.points);
            if (!clean) why = "the cup would meet the body on its way";
          }
        }
        if (!clean) continue;

        Sequence sequence;
        sequence.name = "cup";
        sequence.seed = seed;
        sequence.frames = frames;
        sequence.camera_from_desk = on_tripod();
        sequence.rig = [](int) { return RigState{}; };
        sequence.desk_from_body = desk_from_body;
        sequence.movers = movers;
        sequence.touches = {{"cup",
                             nearest_site(body, desk_from_body.inverse() * push->touched),
                             false,
                             depth,
                             {static_cast<int>(touching), frames - 1},
                             in / kFramesPerSecond,
                             view_angle,
                             push->at_touch,
                             h}};
        if (sequence.touches[0].frames.first >= frames) sequence.touches.clear();
        sequence.spans = {{"let_go", {static_cast<int>(std::ceil(let_go)), frames - 1}}};
        if (sequence.spans[0].frames.first >= frames) sequence.spans.clear();
        return sequence;
      }
  }
  throw Error(
      fmt::format("the sequence 'cup' cannot be planned for this body: {}; the body should be "
                  "0.05 to 0.25 m high and stand round the axis of its frame",
                  why));
}

}  // namespace palpable
