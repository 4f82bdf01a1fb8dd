#include "palpable/slam/slam.h"

#include "palpable/base/contract.h"
#include "palpable/base/cpu_time.h"
#include "palpable/track/sighting.h"
#include "palpable/track/tracker_input.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {
// s by which stamps that are meant to be even are not.
constexpr double kUneven = 1e-4;

// Motions of the frame before: after a longer gap than that the camera has hardly gone on so.
constexpr double kFarthestForetold = 3;

// Before it can follow anything, a camera that still stands has its place where the world begins:
// else a hand before a bare desk would be what is seen first.
bool is_placed(const TrackedPose& camera) {
  return is_known(camera) || camera.state == TrackState::kStarting;
}
}  // namespace

Slam::Slam(const DepthCamera& camera, const FrameFormat& format, const SlamSettings& settings)
    : settings_(settings), noise_(camera.noise()) {
  PALPABLE_EXPECT(settings.fuse_every >= 0, "time does not run backwards");
  PALPABLE_EXPECT(settings.most_moving >= 0 && settings.most_moving <= 1, "a share of the picture");
  if (settings.track) tracker_.emplace(tracker_settings(camera, format));
  if (settings.map) begin_map();
}

void Slam::begin_map() {
  MovingMaskSettings moving = settings_.moving;
  // The map answers for the middle of the nearest voxel: that far beside the point, at its corners.
  moving.step = std::max(moving.step, 0.5 * std::sqrt(3.0) * settings_.surface.voxel + 0.005);
  mover_.emplace(noise_, moving);
  if (map_) {
    map_->clear();
  } else {
    map_.emplace(noise_, settings_.surface);
  }
  last_fused_ = -std::numeric_limits<double>::infinity();
}

const SlamFrame& Slam::advance(const SeenFrame& seen, StageTimes& times) {
  if (!tracker_) return take(seen, {.state = TrackState::kFixed}, times);
  frame_ = {};
  {
    const StageTimer timer(times, "map");
    large_ = nullptr;
    if (is_placed(last_camera_)) { find_moving(seen, foretold(seen.time)); }
  }
  {
    const StageTimer timer(times, "track");
    // A tracker that has not begun takes what it gets: what moves is told from a pose nobody has
    // checked.
    const bool begun = is_known(last_camera_);
    frame_.camera = tracker_->track(tracker_frame(seen, begun ? frame_.moving : nullptr));
  }
  // What moves was found from a pose that turns out to be wrong.
  if (!is_placed(frame_.camera)) frame_.moving = nullptr;
  const StageTimer timer(times, "map");
  if (frame_.camera.closed_loop && map_) {
    frame_.moving = nullptr;  // it belongs to what is forgotten now
    begin_map();
    frame_.corrections = tracker_->corrections();
    last_camera_.state = TrackState::kLost;  // the way from there to here is no motion
  }
  if (frame_.camera.new_world && map_) begin_map();
  learn(seen);
  return frame_;
}

// Where the camera is if it has gone on as before.
Rigid3 Slam::foretold(double time) const {
  const double share =
      last_step_ > 0 ? std::clamp((time - last_time_) / last_step_, 0.0, kFarthestForetold) : 0;
  return last_camera_.world_from_camera * part_of(last_motion_, share);
}

const SlamFrame& Slam::advance(const SeenFrame& seen,
                               const std::optional<Rigid3>& world_from_camera, StageTimes& times) {
  TrackedPose camera{.world_from_camera = last_camera_.world_from_camera,
                     .state = TrackState::kLost};
  if (world_from_camera) camera = {*world_from_camera, TrackState::kTracking};
  return take(seen, camera, times);
}

// With a pose that is not to be tracked.
const SlamFrame& Slam::take(const SeenFrame& seen, const TrackedPose& camera, StageTimes& times) {
  const StageTimer timer(times, "map");
  frame_ = {};
  large_ = nullptr;
  frame_.camera = camera;
  if (is_known(camera)) find_moving(seen, camera.world_from_camera);
  learn(seen);
  return frame_;
}

void Slam::find_moving(const SeenFrame& seen, const Rigid3& world_from_camera) {
  if (!mover_) return;
  const CpuTimer timer(counts_.mask_cpu_s);
  const MaskImage& mask = mover_->find(seen, world_from_camera, map());
  int moving = 0;
  for (const std::uint8_t m : mask) moving += m & 1;  // 255 or 0
  ++counts_.masks;
  if (static_cast<double>(moving) <= settings_.most_moving * static_cast<double>(mask.size())) {
    frame_.moving = &mask;
  } else {
    large_ = &mask;
  }
}

// Takes the frame into the free space and the map, if it is known where it was seen from.
void Slam::learn(const SeenFrame& seen) {
  const bool known = is_placed(frame_.camera);
  const Rigid3& world_from_camera = frame_.camera.world_from_camera;
  if (frame_.camera.state == TrackState::kFixed && last_camera_.state == TrackState::kFixed &&
      frame_.moving == nullptr) {
    frame_.moving = large_;
  }
  last_motion_ = known && is_placed(last_camera_)
                     ? last_camera_.world_from_camera.inverse() * world_from_camera
                     : Rigid3::Identity();
  last_step_ = seen.time - last_time_;
  last_time_ = seen.time;
  last_camera_ = frame_.camera;
  ++counts_.frames;
  if (!known) ++counts_.lost;
  if (frame_.moving == nullptr) return;  // so is what a lost camera sees
  {
    const CpuTimer timer(counts_.mask_cpu_s);
    mover_->learn(world_from_camera);
  }
  if (seen.time - last_fused_ < settings_.fuse_every - kUneven) return;
  last_fused_ = seen.time;
  frame_.fused = true;
  ++counts_.fused;
  const CpuTimer timer(counts_.fuse_cpu_s);
  map_->fuse(seen.depth, seen.depth_camera, world_from_camera, *frame_.moving, seen.color);
}

}  // namespace palpable
