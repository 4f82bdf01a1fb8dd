#include "palpable/desk/script/camera_motions.h"

#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {

namespace {

using Eigen::Vector3d;

constexpr double kSeconds = 1.0 / 30.0;  // s per frame
constexpr double kRest = 60.0;           // frames before the camera begins to move

constexpr double kCameraDistance = 0.44;  // m, from the point it looks at
constexpr double kCameraElevation = 35.0 * kDegree;
const Vector3d kLookedAt(0.012, 0.0, 0.058);

/// An irregular motion: sums of sines for three components of shift and three of rotation, each
/// with its own random phases.
class Unrest {
 public:
  struct Wave {
    double hertz, weight;
  };
  Unrest(std::vector<Wave> waves, std::uint64_t seed, std::string_view name)
      : waves_(std::move(waves)) {
    Random random(seed, name);
    for (std::size_t i = 0; i < 6 * waves_.size(); ++i)
      phases_.push_back(random.between(0.0, kTurn));
    // Slightly different frequencies keep the components from repeating in step.
    for (std::size_t axis = 0; axis < 6; ++axis) detune_[axis] = random.between(0.9, 1.1);
  }
  /// Shift and rotation, both without unit.
  [[nodiscard]] std::pair<Vector3d, Vector3d> at(double frame) const {
    std::array<double, 6> sum{};
    for (std::size_t axis = 0; axis < 6; ++axis)
      for (std::size_t w = 0; w < waves_.size(); ++w)
        sum[axis] +=
            waves_[w].weight * std::sin(kTurn * waves_[w].hertz * detune_[axis] * frame * kSeconds +
                                        phases_[axis * waves_.size() + w]);
    return {{sum[0], sum[1], sum[2]}, {sum[3], sum[4], sum[5]}};
  }
  /// The largest shift and the largest rotation within the first `frames` frames.
  [[nodiscard]] std::pair<double, double> largest(int frames) const {
    double shift = 0.0;
    double turn = 0.0;
    for (int frame = 0; frame < frames; ++frame) {
      const auto [s, t] = at(frame);
      shift = std::max(shift, s.norm());
      turn = std::max(turn, t.norm());
    }
    return {shift, turn};
  }

 private:
  std::vector<Wave> waves_;
  std::vector<double> phases_;
  std::array<double, 6> detune_{};
};

/// The camera shifted by `shift` (m) and rotated by `turn` (rad), both in its own axes.
Rigid3 moved(const Rigid3& camera_from_desk, const Vector3d& shift, const Vector3d& turn) {
  const double angle = turn.norm();
  Rigid3 change = Rigid3::Identity();
  if (angle > 0.0) change.linear() = Eigen::AngleAxisd(-angle, turn / angle).toRotationMatrix();
  change.translation() = -(change.linear() * shift);
  return change * camera_from_desk;
}

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (10.0 + t * (6.0 * t - 15.0));  // no jump in speed or acceleration
}

struct Waypoint {
  double frame;
  Vector3d eye, target;
};

/// A cubic through the way points. The tangent at a way point is the slope between its neighbours,
/// and zero at both ends.
Vector3d along(std::span<const Waypoint> way, Vector3d Waypoint::*part, double frame) {
  const auto n = way.size();
  std::size_t k = 0;
  while (k + 2 < n && way[k + 1].frame <= frame) ++k;
  const double span = way[k + 1].frame - way[k].frame;
  const double t = std::clamp((frame - way[k].frame) / span, 0.0, 1.0);
  const auto tangent = [&](std::size_t i) -> Vector3d {
    if (i == 0 || i + 1 == n) return Vector3d::Zero();
    return (way[i + 1].*part - way[i - 1].*part) / (way[i + 1].frame - way[i - 1].frame);
  };
  const double t2 = t * t;
  const double t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * (way[k].*part) + (t3 - 2 * t2 + t) * span * tangent(k) +
         (3 * t2 - 2 * t3) * (way[k + 1].*part) + (t3 - t2) * span * tangent(k + 1);
}

}  // namespace

Vector3d first_eye() {
  return kLookedAt +
         kCameraDistance * Vector3d(0.0, -std::cos(kCameraElevation), std::sin(kCameraElevation));
}

Rigid3 first_camera_from_desk() { return look_at(first_eye(), kLookedAt); }

Rigid3 look_at(const Vector3d& from, const Vector3d& at) {
  const Vector3d z = (at - from).normalized();
  const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
  Rigid3 desk_from_camera = Rigid3::Identity();
  desk_from_camera.linear().col(0) = x;
  desk_from_camera.linear().col(1) = z.cross(x);
  desk_from_camera.linear().col(2) = z;
  desk_from_camera.translation() = from;
  return desk_from_camera.inverse();
}

CameraPath on_tripod() {
  return [pose = first_camera_from_desk()](double) { return pose; };
}

Sequence tripod_sequence(std::string_view name, int frames, std::uint64_t seed) {
  Sequence sequence;
  sequence.name = name;
  sequence.seed = seed;
  sequence.frames = frames;
  sequence.camera_from_desk = on_tripod();
  sequence.rig = [](int) { return RigState{}; };
  sequence.movers = [](double) { return Movers{}; };
  return sequence;
}

CameraPath held(CameraPath path, int frames, std::uint64_t seed) {
  const Unrest unrest({{0.31, 1.0}, {0.83, 0.45}, {2.1, 0.15}, {6.7, 0.06}}, seed, "held");
  Random random(seed, "how calm");
  const auto [shift, turn] = unrest.largest(frames);
  const double metres = random.between(0.0024, 0.0038) / std::max(shift, 1e-9);
  const double radians = 0.3 * kDegree / std::max(turn, 1e-9);
  return [path = std::move(path), unrest, metres, radians](double frame) {
    const auto [s, t] = unrest.at(frame);
    return moved(path(frame), metres * s, radians * t);
  };
}

CameraPath walk() {
  static const std::array<Waypoint, 12> kWay = {{
      {kRest, first_eye(), kLookedAt},
      {150, {-0.35, -0.75, 0.55}, {0.00, 0.10, 0.02}},
      {245, {-1.10, -1.25, 0.75}, {-0.05, 0.40, -0.05}},
      {330, {-1.70, -0.65, 0.80}, {0.20, 0.45, 0.00}},
      {450, {-0.70, -1.50, 0.82}, {0.10, 1.00, 0.00}},
      {525, {0.25, -1.62, 0.80}, {0.45, 1.20, 0.10}},
      {575, {0.65, -1.60, 0.80}, {3.60, -0.10, 0.40}},  // a look to the right, away from the desk
      {610, {0.85, -1.52, 0.80}, {4.10, 0.10, 0.30}},
      {665, {0.95, -1.35, 0.75}, {0.50, 0.80, 0.00}},
      {750, {0.50, -0.70, 0.50}, {0.00, 0.10, 0.04}},
      {830, {-0.24, -0.06, 0.27}, {-0.25, 0.20, 0.06}},  // close above the books
      {899, {0.05, -0.40, 0.34}, kLookedAt},
  }};
  return [](double frame) {
    const Vector3d eye = along(kWay, &Waypoint::eye, frame);
    // Steps: the head moves up and down, the more the faster the camera moves.
    const Vector3d before = along(kWay, &Waypoint::eye, frame - 1.0);
    const double speed = (eye - before).norm() / kSeconds;
    const double bounce =
        0.010 * std::min(1.0, speed / 0.3) * std::sin(kTurn * 1.7 * (frame - kRest) * kSeconds);
    return look_at(eye + bounce * Vector3d::UnitZ(), along(kWay, &Waypoint::target, frame));
  };
}

CameraPath shaken(std::uint64_t seed) {
  const Unrest unrest({{2.6, 1.0}, {3.9, 0.7}, {5.0, 0.35}}, seed, "shaken");
  const auto [shift, turn] = unrest.largest(3000);
  return [unrest, metres = 0.014 / shift, radians = 2.5 * kDegree / turn](double frame) {
    // Bursts of 3 s with 1 s of rest.
    const double in_cycle = std::fmod(std::max(0.0, frame - kRest), 120.0);
    const double strength =
        frame < kRest ? 0.0 : smooth_step(in_cycle / 12.0) * smooth_step((90.0 - in_cycle) / 12.0);
    const auto [s, t] = unrest.at(frame);
    return moved(first_camera_from_desk(), strength * metres * s, strength * radians * t);
  };
}

CameraPath fast_turns(std::uint64_t seed) {
  // Yaw after each turn: to one side, back to the desk (0), to one side and so on.
  std::vector<double> ends = {0.0};
  Random random(seed, "turns");
  for (int i = 0; i < 200; ++i) {
    const double size = random.between(30.0, 40.0) * kDegree;
    ends.push_back(ends.back() == 0.0 ? random.sign() * size : 0.0);
  }
  return [ends](double frame) {
    constexpr double kCycle = 66.0;  // frames from one turn to the next
    constexpr double kQuick = 12.0;  // duration of a turn, frames
    const double since = std::max(0.0, frame - kRest);
    const auto i = std::min(static_cast<std::size_t>(since / kCycle), ends.size() - 2);
    const double t = (since - kCycle * static_cast<double>(i)) / kQuick;
    const double yaw = ends[i] + (ends[i + 1] - ends[i]) * smooth_step(t);
    // The head turns about an upright axis through the neck, 0.09 m behind the camera.
    const Vector3d eye = first_eye();
    const Eigen::AngleAxisd turn(yaw, Vector3d::UnitZ());
    const Vector3d neck = eye + Vector3d(0.0, -0.09, 0.0);
    const Vector3d at = neck + turn * (eye - neck);
    return look_at(at, at + turn * (kLookedAt - eye));
  };
}

CameraPath swaying(std::uint64_t seed) {
  const Unrest unrest({{0.35, 1.0}, {0.72, 0.5}}, seed, "sway");
  const auto [shift, turn] = unrest.largest(3000);
  return [unrest, metres = 0.035 / shift, radians = 6.0 * kDegree / turn](double frame) {
    const double strength = smooth_step((frame - 0.5 * kRest) / 30.0);
    const auto [s, t] = unrest.at(frame);
    return moved(first_camera_from_desk(), strength * metres * s, strength * radians * t);
  };
}

}  // namespace palpable
