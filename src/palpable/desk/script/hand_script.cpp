#include "palpable/desk/script/hand_script.h"

#include "palpable/desk/script/camera_motions.h"
#include "palpable/desk/script/contact_truth.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace palpable {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kWayToTarget =
    14;  // frames from the rest position to the start of the straight approach

int to_frame(double at) { return static_cast<int>(std::lround(at)); }

}  // namespace

Vector3d tip_for_knuckles(const HandTool& tool, const Vector3d& knuckles, const Quaterniond& turn) {
  return knuckles + turn * (tip_in_wrist(tool, tool.passing) - Vector3d(0.08, 0.0, 0.0));
}

Quaterniond resting_turn() {
  return Quaterniond(frame_of({-0.93, -0.20, -0.25}, {-0.15, -0.30, 0.94}));
}

Quaterniond turn_before_camera() {
  return Quaterniond(frame_of({-0.95, 0.16, -0.12}, {-0.10, -0.55, 0.83}));
}

std::function<Movers(double)> hand_alone(HandPath path) {
  return [path = std::move(path)](double frame) {
    return frame < kFramesWithoutHand ? Movers{} : Movers{path.capsules(frame), std::nullopt};
  };
}

HandScript::HandScript(const PressSearch& search, const SurfacePoints& surface,
                       const PressStyle& style, std::uint64_t seed)
    : search_(search), surface_(surface), style_(style), rest_turn_(resting_turn()) {
  path_.tool = style.tool;
  path_.arm = style.arm;
  path_.tremor_seed = seed;
  rest_ = tip_for_knuckles(style.tool, {0.25, 0.05, 0.14}, rest_turn_);
  key(0, tip_for_knuckles(style.tool, {0.62, 0.16, 0.24}, rest_turn_), rest_turn_, 0.6);
  key(18, rest_, rest_turn_, 0.5);
}

bool HandScript::press(const PressPosture& posture, double depth, const Pace& pace) {
  const Vector3d deepest = posture.touch + depth * posture.target.direction;
  return touch(posture, depth, pace, {deepest, deepest});
}

bool HandScript::slide(const PressPosture& from, const PressTarget& to, double depth,
                       const Pace& pace) {
  constexpr int kParts = 12;
  constexpr double kFold =
      0.012;  // m, larger steps between neighbouring points mean a fold of the surface
  std::vector<Vector3d> places;
  for (int i = 0; i <= kParts; ++i) {
    const double t = static_cast<double>(i) / kParts;
    const Vector3d x = from.target.x + t * (to.x - from.target.x);
    const Vector3d d =
        (from.target.direction + t * (to.direction - from.target.direction)).normalized();
    const auto place = search_.first_touch(x, d, from.turn, style_.tool, style_.arm);
    if (!place) return false;
    places.push_back(*place + depth * d);
    if (i > 0 && (places[i] - places[i - 1]).norm() > kFold) return false;
  }
  return touch(from, depth, pace, places);
}

void HandScript::pass_the_lens(double frames) {
  const Quaterniond turn = turn_before_camera();
  const Rigid3 desk_from_camera = first_camera_from_desk().inverse();
  const auto at = [&](double x, double y, double z) -> Vector3d {
    return desk_from_camera * Vector3d(x, y, z);
  };
  const double start = now();
  key(start + 16, at(0.13, 0.055, 0.15), turn, 0.2);
  key(start + 24, at(0.012, 0.030, 0.098), turn, 0.1);
  key(start + 24 + 0.5 * frames, at(-0.012, 0.020, 0.092), turn, 0.0);
  key(start + 24 + frames, at(0.005, 0.035, 0.100), turn, 0.15);
  key(start + 34 + frames, at(0.15, 0.060, 0.17), turn, 0.4);
  key(start + 50 + frames, rest_, rest_turn_, 0.5);
  spans_.push_back({"hand_near", {to_frame(start + 24), to_frame(start + 24 + frames)}});
}

void HandScript::work_in_front(double frames) {
  const Quaterniond turn = turn_before_camera();
  const Quaterniond other(frame_of({-0.86, 0.30, 0.35}, {-0.30, -0.75, 0.60}));
  const Rigid3 desk_from_camera = first_camera_from_desk().inverse();
  const auto at = [&](double x, double y, double z, const Quaterniond& how) {
    return tip_for_knuckles(style_.tool, desk_from_camera * Vector3d(x, y, z), how);
  };
  const double start = now();
  key(start + 16, at(0.24, 0.03, 0.26, turn), turn, 0.8);
  key(start + 26, at(0.09, 0.02, 0.22, turn), turn, 1.0);
  key(start + 26 + 0.35 * frames, at(0.05, -0.01, 0.17, other), other, 0.6);
  key(start + 26 + 0.65 * frames, at(0.06, 0.03, 0.15, turn), turn, 0.9);
  key(start + 26 + frames, at(0.10, 0.01, 0.21, turn), turn, 1.0);
  key(start + 38 + frames, at(0.25, 0.05, 0.27, turn), turn, 0.7);
  key(start + 54 + frames, rest_, rest_turn_, 0.5);
  spans_.push_back({"hand_in_front", {to_frame(start + 26), to_frame(start + 26 + frames)}});
}

bool HandScript::turn_in_view(double angle, double frames) {
  constexpr double kFirst = 24;  // frames, of the first turn
  constexpr double kStill = 4;   // frames, between the turns, and before and after them
  // The forearm passes through the middle of the picture, 0.28 m before the eye. What the hand
  // holds comes within 0.2 m of the eye, and of the body stays clear.
  const Vector3d knuckles = first_camera_from_desk().inverse() * Vector3d(0.045, -0.005, 0.28);
  const Vector3d pivot(0.085, 0.0, 0.0);  // between the knuckles, wrist frame
  const Vector3d forearm = Vector3d::UnitX();
  const Quaterniond palm_down(frame_of(-forearm, Vector3d::UnitZ()));
  const Quaterniond palm_up = Eigen::AngleAxisd(-angle, forearm) * palm_down;
  const std::size_t keys_before = path_.keys.size();
  const double start = now();
  const auto turn_to = [&](double at, const Quaterniond& turn, double by) {
    const Vector3d tip = knuckles + turn * (tip_in_wrist(style_.tool, style_.tool.working) - pivot);
    key(at, tip, turn, 0.0);
    path_.keys.back().spin = {by, forearm, pivot};
  };
  const double first = start + 18;
  const double back = first + kStill + kFirst + kStill;
  turn_to(first, palm_down, 0.0);
  turn_to(first + kStill, palm_down, 0.0);
  turn_to(first + kStill + kFirst, palm_up, -angle);
  turn_to(back, palm_up, 0.0);
  turn_to(back + frames, palm_down, angle);
  turn_to(back + frames + kStill, palm_down, 0.0);
  if (!stays_clear(start)) {
    path_.keys.resize(keys_before);
    return false;
  }
  spans_.push_back({"turned", {to_frame(back), to_frame(back + frames)}});
  return true;
}

void HandScript::wait(double frames) { key(now() + frames, rest_, rest_turn_, 0.5); }

void HandScript::key(double at, const Vector3d& tip, const Quaterniond& turn, double open) {
  // The times of the two keys of the constructor are relative to the first frame with a hand.
  const double start = path_.keys.size() < 2 ? kFramesWithoutHand : 0.0;
  path_.keys.push_back({start + at, tip, turn, open});
}

/// Adds a touch: a straight approach to the first of the places, motion through all of them at the
/// full depth, straight withdrawal from the last one, and return to the rest position. @return
/// false, with nothing added, when touches_only() fails
bool HandScript::touch(const PressPosture& posture, double depth, const Pace& pace,
                       const std::vector<Vector3d>& places) {
  const std::size_t keys_before = path_.keys.size();
  const Vector3d before = posture.touch - style_.rules.approach * posture.target.direction;
  const double start = now();
  const double first = start + kWayToTarget;
  key(first, before, posture.turn, 0.0);
  for (std::size_t i = 0; i < places.size(); ++i)
    key(first + pace.in +
            pace.hold * static_cast<double>(i) / static_cast<double>(places.size() - 1),
        places[i], posture.turn, 0.0);
  const Vector3d away = places.back() - places.front() + before;
  key(first + pace.in + pace.hold + pace.out, away, posture.turn, 0.0);
  key(first + pace.in + pace.hold + pace.out + kWayToTarget, rest_, rest_turn_, 0.5);
  const FrameSpan frames{static_cast<int>(std::floor(first)),
                         static_cast<int>(std::ceil(first + pace.in + pace.hold + pace.out))};
  if (!touches_only(posture, places, frames, start)) {
    path_.keys.resize(keys_before);
    return false;
  }
  touches_.push_back({style_.what, posture.target.site, posture.target.between, depth, frames,
                      pace.in / kFramesPerSecond, posture.view_angle, posture.touch,
                      posture.target.direction});
  return true;
}

/// Whether the hand, since frame `start`, touches neither desk nor body. Sets why_not_ otherwise.
bool HandScript::stays_clear(double start) {
  for (int frame = static_cast<int>(std::ceil(start)); frame <= std::floor(now()); ++frame) {
    const std::vector<Capsule> hand = shapes_of(path_.capsules(frame));
    const bool on_desk = lowest_point(hand) < 0.0;
    if (!on_desk && !palpable::touches(hand, surface_.points)) continue;
    why_not_ = on_desk ? "the hand that turns would meet the desk"
                       : "the hand that turns would meet the body";
    return false;
  }
  return true;
}

/// Whether the hand, since frame `start`, touches the body only within `frames` and only near the
/// target or the places, and does touch it there. Sets why_not_ otherwise.
bool HandScript::touches_only(const PressPosture& posture, const std::vector<Vector3d>& places,
                              FrameSpan frames, double start) {
  bool touched = false;
  for (int frame = static_cast<int>(std::ceil(start)); frame <= std::floor(now()); ++frame) {
    const std::vector<Capsule> hand = shapes_of(path_.capsules(frame));
    if (lowest_point(hand) < 0.0) {
      why_not_ = "the hand would meet the desk";
      return false;
    }
    const PressTruth truth = press_truth(hand, surface_);
    if (!truth.touching) continue;
    const Vector3d x = surface_.points.col(truth.point);
    double nearest = (x - posture.target.x).norm();
    for (const Vector3d& place : places) nearest = std::min(nearest, (x - place).norm());
    if (frame < frames.first || frame > frames.last || nearest > style_.rules.near) {
      why_not_ = fmt::format("the hand would meet the body {:.0f} mm beside the planned place",
                             1e3 * nearest);
      return false;
    }
    touched = true;
  }
  if (!touched) why_not_ = "the press would not touch";
  return touched;
}

}  // namespace palpable
