#include "palpable/live/seen_object/surface_friction.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

using Eigen::Vector3f;

constexpr int kFadeFrames = 6;
constexpr float kTrembles = 3;  // standard deviations by which a surface at rest may move
// Standard deviations: a ball that moves by less in a frame, and has less than a quarter of it
// pending, rests.
constexpr float kRests = 1;
constexpr double kForgets = 1;  // s, in which what is pending at rest falls to 1/e
// m: what is kept is taken from the nearest ball of the frame before up to this distance.
constexpr float kSameThing = 0.010f;
constexpr float kLongestJump = 0.1f;             // m, of a thing's middle
constexpr std::size_t kFrictionBallRoom = 8192;  // balls, as ObjectSurface

}  // namespace

SurfaceFriction::SurfaceFriction() {
  for (auto* list : {&memory_, &memory_before_}) list->reserve(kFrictionBallRoom);
  found_.reserve(kFrictionBallRoom);
  constexpr std::size_t kThingRoom = 256;
  for (auto* list : {&centres_before_, &jumps_}) list->reserve(kThingRoom);
  known_.reserve(kThingRoom);
  for (auto* list : {&seen_, &taken_}) list->reserve(kThingRoom);
}

void SurfaceFriction::add(ObjectSurface& surface, const Vector3f& camera, double time) {
  const std::span<const ObjectBall> balls = surface.balls();
  if (balls.empty()) {  // nothing rubs; what comes back soon is the same thing
    gone_ = std::min(gone_ + 1, kFadeFrames);
    return;
  }
  memory_.swap(memory_before_);
  if (memory_before_.size() != surface.before().balls().size()) memory_before_.clear();
  centres_before_.assign(things_.centres().begin(), things_.centres().end());
  things_.find(balls);
  motion_.add(balls, camera, time, things_.of_balls());
  find_seen();
  find_jumps();
  find_ways(surface);
  find_known();
  for (std::size_t k = 0; k < balls.size(); ++k) {
    const int known = known_[static_cast<std::size_t>(things_.of_balls()[k])];
    memory_[k].known = known;
    found_[k].friction_share = static_cast<float>(known) / static_cast<float>(kFadeFrames);
  }
  gone_ = 0;
  surface.set_motion(found_);
}

// Which things were seen in the frame before.
void SurfaceFriction::find_seen() {
  seen_.assign(things_.centres().size(), 0);
  for (std::size_t k = 0; k < motion_.measured().size(); ++k) {
    if (!motion_.measured()[k].is_seen) continue;
    seen_[static_cast<std::size_t>(things_.of_balls()[k])] = 1;
  }
}

// The number of the thing of the frame before whose middle is nearest to that of a thing, among
// those that are not taken; -1: none is near.
int SurfaceFriction::nearest_before(std::size_t thing) const {
  float nearest = kLongestJump;
  int found = -1;
  for (std::size_t b = 0; b < centres_before_.size(); ++b) {
    const float jump = (things_.centres()[thing] - centres_before_[b]).norm();
    if (taken_[b] == 0 && jump < nearest) nearest = jump, found = static_cast<int>(b);
  }
  return found;
}

// The ways of the middles of things that were not seen in the frame before: each from the nearest
// thing that is not one of those which were seen. 0 without one.
void SurfaceFriction::find_jumps() {
  jumps_.assign(seen_.size(), Vector3f::Zero());
  taken_.assign(centres_before_.size(), 0);
  for (std::size_t t = 0; t < seen_.size(); ++t) {
    const int before = seen_[t] != 0 ? nearest_before(t) : -1;
    if (before >= 0) taken_[static_cast<std::size_t>(before)] = 1;
  }
  for (std::size_t t = 0; t < seen_.size(); ++t) {
    const int before = seen_[t] == 0 ? nearest_before(t) : -1;
    if (before < 0) continue;
    jumps_[t] = things_.centres()[t] - centres_before_[static_cast<std::size_t>(before)];
  }
}

// The way of each ball, and what is known of it from the frame before.
void SurfaceFriction::find_ways(const ObjectSurface& surface) {
  const std::span<const ObjectBall> balls = surface.balls();
  const auto kept = static_cast<float>(std::exp(-motion_.interval() / kForgets));
  memory_.assign(balls.size(), {});
  found_.assign(balls.size(), {});
  for (std::size_t k = 0; k < balls.size(); ++k) {
    // What is held stands still.
    const bool is_held = balls[k].unseen_for > 0;
    const SurfaceMotion::Way& measured = motion_.measured()[k];
    Vector3f w = Vector3f::Zero();
    if (!is_held) {
      w = measured.is_seen ? measured.way : jumps_[static_cast<std::size_t>(things_.of_balls()[k])];
    }
    if (!memory_before_.empty()) {
      const auto before = surface.before().nearest(balls[k].centre - w, kSameThing);
      if (before) memory_[k] = memory_before_[static_cast<std::size_t>(before->ball)];
    }
    found_[k].way = follow(w, balls[k].sigma, kept, memory_[k]);
    found_[k].way_is_mean = !is_held && !(measured.is_seen && measured.is_own);
  }
}

// The way of a ball of which `w` was measured. @param kept  share of what is pending at rest
Vector3f SurfaceFriction::follow(const Vector3f& w, float sigma, float kept, Memory& memory) {
  if (!memory.moves) memory.pending *= kept;
  const Vector3f all = memory.pending + w;
  if (!memory.moves && !(all.norm() > kTrembles * sigma)) {
    memory.pending = all;
    return Vector3f::Zero();
  }
  memory.pending *= 0.5f;
  memory.moves = w.norm() > kRests * sigma || memory.pending.norm() > kRests * sigma / 4;
  return all - memory.pending;
}

// How long the motion of each thing has been known: that of its balls which is known longest, so
// that things which meet or part keep their friction.
void SurfaceFriction::find_known() {
  known_.assign(things_.centres().size(), 0);
  for (std::size_t k = 0; k < memory_.size(); ++k) {
    const auto thing = static_cast<std::size_t>(things_.of_balls()[k]);
    known_[thing] = std::max(known_[thing], memory_[k].known - gone_);
  }
  for (std::size_t t = 0; t < known_.size(); ++t) {
    known_[t] = std::clamp(known_[t] + (seen_[t] != 0 ? 1 : -1), 0, kFadeFrames);
  }
}

}  // namespace palpable
