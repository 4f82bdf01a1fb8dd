#include "palpable/live/seen_object/held_balls.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Vector3d;

// m: room that is nearer than a ball's front by more than this hides the ball; less is noise.
constexpr float kHides = 0.02f;

// Things have vanished when fewer balls are measured than this share of the last frame's.
constexpr double kStillSeen = 0.5;

enum class Seen { kPresser, kRoom, kUnknown };

// What pixel (u, v) shows with respect to a position at depth z on its ray.
Seen look(const DepthImage& depth, const MaskImage& shows, double u, double v, float z) {
  const int x = static_cast<int>(std::lround(u)), y = static_cast<int>(std::lround(v));
  if (x < 0 || y < 0 || x >= depth.width() || y >= depth.height()) return Seen::kUnknown;
  if (shows(x, y) == kShowsPresser) return Seen::kPresser;
  if (!shows_room(shows(x, y))) return Seen::kUnknown;
  return depth(x, y) < z - kHides ? Seen::kUnknown : Seen::kRoom;  // false for NaN
}

// Whether more of five pixels on the ball show something unknown than show the room, and none shows
// a presser.
bool is_unknown(const ObjectBall& ball, const DepthImage& depth, const MaskImage& shows,
                const PinholeCamera& camera, const Rigid3& camera_from_body) {
  const Vector3d x = camera_from_body * ball.point.cast<double>();
  if (!(x.z() > 0)) return true;
  const double u = camera.cx_px + camera.fx_px * x.x() / x.z();
  const double v = camera.cy_px + camera.fy_px * x.y() / x.z();
  const double beside =
      std::max(1.0, 0.5 * camera.fx_px * static_cast<double>(ball.radius) / x.z());
  int unknown = 0, room = 0;
  constexpr std::array<std::array<int, 2>, 5> kPlaces{{{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  for (const auto& [dx, dy] : kPlaces) {
    const Seen seen =
        look(depth, shows, u + dx * beside, v + dy * beside, static_cast<float>(x.z()));
    if (seen == Seen::kPresser) return false;
    ++(seen == Seen::kRoom ? room : unknown);
  }
  return unknown > room;
}

}  // namespace

HeldBalls::HeldBalls(const HoldSettings& settings) : settings_(settings) {
  PALPABLE_EXPECT(settings.hold >= 0 && settings.fade > 0, "what is unknown fades some day");
}

void HeldBalls::recall(const DepthImage& depth, const MaskImage& shows, const PinholeCamera& camera,
                       const Rigid3& camera_from_body, double time,
                       std::vector<ObjectBall>& balls) {
  const auto passed = static_cast<float>(std::max(0.0, time - time_));
  time_ = time;
  const std::size_t measured = balls.size();
  const bool vanished =
      static_cast<double>(measured) < kStillSeen * static_cast<double>(measured_before_);
  const auto hold = static_cast<float>(settings_.hold), fade = static_cast<float>(settings_.fade);
  for (ObjectBall ball : before_) {
    ball.unseen_for += passed;
    if (ball.unseen_for >= hold + fade) continue;
    if (ball.unseen_for == passed && !vanished) continue;  // its thing is seen elsewhere
    if (is_unknown(ball, depth, shows, camera, camera_from_body)) balls.push_back(ball);
  }
  before_.assign(balls.begin(), balls.end());
  measured_before_ = measured;
  for (std::size_t k = measured; k < balls.size(); ++k) {
    const float left = (hold + fade - balls[k].unseen_for) / fade;
    balls[k].radius *= std::clamp(left, 0.0f, 1.0f);
  }
}

}  // namespace palpable
