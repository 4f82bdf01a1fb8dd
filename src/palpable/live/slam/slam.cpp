#include "palpable/live/slam/slam.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/live/track/sighting.h"
#include "palpable/live/track/tracker_input.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

// s; tolerance for time stamps that are meant to be evenly spaced.
constexpr double kUneven = 1e-4;

// Largest factor by which the last motion is extrapolated after missing frames.
constexpr double kLongestPrediction = 3;

// px; error of the predicted pose, as a shift of the picture, above which the mask is computed
// again with the pose that was found.
constexpr double kMostSurprise = 4;

// Whether the frame has a pose with which the map may be updated. This includes a camera that
// stands still before there is a keyframe, at the world's origin. Without that, the first landmarks
// in front of a bare desk would be those on a hand.
bool is_placed(const TrackedPose& camera) {
  return is_known(camera) || camera.state == TrackState::kStarting;
}
}  // namespace

Slam::Slam(const DepthCamera& camera, const SlamSettings& settings)
    : settings_(settings), noise_(camera.noise()) {
  PALPABLE_EXPECT(settings.fuse_every >= 0, "a time between depth images is not negative");
  PALPABLE_EXPECT(settings.most_moving >= 0 && settings.most_moving <= 1, "a share of the picture");
  if (settings.track) tracker_.emplace(tracker_settings(camera));
  if (settings.map) begin_map();
}

void Slam::begin_map() {
  MovingMaskSettings moving = settings_.moving;
  // The map's distance refers to the middle of a voxel, from which a point in the voxel's corner is
  // half a diagonal away. The mask's tolerance is at least that plus 5 mm.
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
  if (!tracker_) return advance_at({.state = TrackState::kFixed}, seen, times);
  frame_ = {};
  {
    const StageTimer timer(times, "map");
    large_mask_ = nullptr;
    if (is_placed(last_camera_)) find_moving(seen, predicted_pose(seen.time));
  }
  {
    const StageTimer timer(times, "track");
    // Before there is a keyframe, the mask was computed with an unconfirmed pose. The tracker then
    // searches its first landmarks in the whole picture.
    const bool has_keyframe = is_known(last_camera_);
    frame_.camera = tracker_->track(tracker_frame(seen, has_keyframe ? frame_.moving : nullptr));
  }
  const StageTimer timer(times, "map");
  // Discards the mask if the predicted pose turned out to be wrong.
  if (!is_placed(frame_.camera)) frame_.moving = nullptr;
  const bool has_mask = frame_.moving != nullptr || large_mask_ != nullptr;
  if (has_mask && frame_.camera.prediction_error_px > kMostSurprise) {
    frame_.moving = large_mask_ = nullptr;
    find_moving(seen, frame_.camera.world_from_camera);
  }
  if (frame_.camera.closed_loop && map_) {
    frame_.moving = nullptr;  // it was computed with the map that is now cleared
    begin_map();
    frame_.corrections = tracker_->corrections();
    last_camera_.state = TrackState::kLost;  // the step to the corrected pose is not a motion
  }
  if (frame_.camera.new_world && map_) begin_map();
  learn(seen);
  return frame_;
}

// world_from_camera at `time`, extrapolated from the last motion.
Rigid3 Slam::predicted_pose(double time) const {
  const double share = last_motion_time_ > 0 ? std::clamp((time - last_time_) / last_motion_time_,
                                                          0.0, kLongestPrediction)
                                             : 0;
  return last_camera_.world_from_camera * part_of(before_from_last_, share);
}

const SlamFrame& Slam::advance(const SeenFrame& seen,
                               const std::optional<Rigid3>& world_from_camera, StageTimes& times) {
  TrackedPose camera{.world_from_camera = last_camera_.world_from_camera,
                     .state = TrackState::kLost};
  if (world_from_camera) camera = {*world_from_camera, TrackState::kTracking};
  return advance_at(camera, seen, times);
}

const SlamFrame& Slam::advance_at(const TrackedPose& camera, const SeenFrame& seen,
                                  StageTimes& times) {
  const StageTimer timer(times, "map");
  frame_ = {};
  large_mask_ = nullptr;
  frame_.camera = camera;
  if (is_known(camera)) find_moving(seen, camera.world_from_camera);
  learn(seen);
  return frame_;
}

void Slam::find_moving(const SeenFrame& seen, const Rigid3& world_from_camera) {
  if (!mover_) return;
  const CpuTimer timer(counts_.mask_cpu_s);
  const MaskImage& mask = mover_->find(seen, world_from_camera, map());
  frame_.looked_at = mover_->looked_at();
  frame_.picture = mover_->picture();
  int moving = 0;
  for (const std::uint8_t m : mask) moving += m & 1;  // 255 or 0
  ++counts_.masks;
  if (static_cast<double>(moving) <= settings_.most_moving * static_cast<double>(mask.size())) {
    frame_.moving = &mask;
  } else {
    large_mask_ = &mask;
  }
}

// Updates the last motion, and free space and map if the pose is known and the mask is usable.
void Slam::learn(const SeenFrame& seen) {
  const bool known = is_placed(frame_.camera);
  const Rigid3& world_from_camera = frame_.camera.world_from_camera;
  if (frame_.camera.state == TrackState::kFixed && last_camera_.state == TrackState::kFixed &&
      frame_.moving == nullptr) {
    frame_.moving = large_mask_;
  }
  if (frame_.moving != nullptr) frame_.borrowed = &mover_->borrowed();
  before_from_last_ = known && is_placed(last_camera_)
                          ? last_camera_.world_from_camera.inverse() * world_from_camera
                          : Rigid3::Identity();
  last_motion_time_ = seen.time - last_time_;
  last_time_ = seen.time;
  last_camera_ = frame_.camera;
  ++counts_.frames;
  if (!known) ++counts_.lost;
  if (frame_.moving == nullptr) return;  // also in each frame of a lost camera
  {
    const CpuTimer timer(counts_.mask_cpu_s);
    mover_->learn(world_from_camera);
  }
  if (seen.time - last_fused_ < settings_.fuse_every - kUneven) return;
  last_fused_ = seen.time;
  frame_.fused = true;
  ++counts_.fused;
  const CpuTimer timer(counts_.fuse_cpu_s);
  unfit_ = *frame_.moving;
  const MaskImage& borrowed = mover_->borrowed();
  for (std::size_t k = 0; k < unfit_.size(); ++k) unfit_.data()[k] |= borrowed.data()[k];
  map_->fuse(seen.depth, seen.depth_camera, world_from_camera, unfit_, seen.color);
}

}  // namespace palpable
