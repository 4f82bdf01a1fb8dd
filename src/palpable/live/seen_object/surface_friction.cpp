#include "palpable/live/seen_object/surface_friction.h"

#include <algorithm>
#include <cstddef>

namespace palpable {
namespace {

using Eigen::Vector3f;

constexpr int kFadeFrames = 6;
constexpr float kTrembles = 3;  // standard deviations by which a surface at rest may move
// m: what is pending is taken from the nearest ball of the frame before up to this distance.
constexpr float kSameThing = 0.010f;
constexpr std::size_t kFrictionBallRoom = 8192;  // balls, as ObjectSurface

}  // namespace

SurfaceFriction::SurfaceFriction() {
  before_.reserve(kFrictionBallRoom);
  for (auto* list : {&pending_, &next_, &ways_}) list->reserve(kFrictionBallRoom);
  bare_.reserve(kFrictionBallRoom);
}

Vector3f SurfaceFriction::pending_before_at(const Vector3f& place) const {
  const auto found = before_.nearest(place, kSameThing);
  return found ? pending_[static_cast<std::size_t>(found->ball)] : Vector3f::Zero();
}

void SurfaceFriction::add(ObjectSurface& surface, const Vector3f& camera, double time) {
  motion_.add(surface.balls(), camera, time);
  const std::span<const ObjectBall> balls = surface.balls();
  const bool is_known = motion_.interval() > 0 && !balls.empty();
  if (balls.empty()) {
    known_ = 0;
  } else {
    known_ = std::clamp(known_ + (is_known ? 1 : -1), 0, kFadeFrames);
  }
  ways_.assign(balls.size(), Vector3f::Zero());
  next_.assign(balls.size(), Vector3f::Zero());
  for (std::size_t k = 0; is_known && k < balls.size(); ++k) {
    const Vector3f moved = static_cast<float>(motion_.interval()) * motion_.velocities()[k];
    const Vector3f all = pending_before_at(balls[k].centre - moved) + moved;
    const float size = all.norm(), dead = kTrembles * balls[k].sigma;
    if (size > dead) ways_[k] = (1 - dead / size) * all;
    next_[k] = all - ways_[k];
  }
  bare_.clear();
  for (const ObjectBall& ball : balls) bare_.push_back({ball.centre, ball.radius});
  before_.build(bare_);
  pending_.swap(next_);
  surface.set_motion(ways_, static_cast<float>(known_) / static_cast<float>(kFadeFrames));
}

}  // namespace palpable
