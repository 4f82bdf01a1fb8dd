#include "palpable/live/track/recent_poses.h"

#include "palpable/live/track/picture_shift.h"

#include <algorithm>
#include <iterator>

namespace palpable {
namespace {

constexpr double kRestSeconds = 0.7;
constexpr int kMoments = 128;  // capacity; more than the frames in that time at 120 per second

}  // namespace

RecentPoses::RecentPoses() { poses_.reserve(kMoments); }

bool RecentPoses::add_and_check_rest(const TrackCamera& camera, double depth, double time,
                                     const Rigid3& camera_from_world) {
  poses_.push_back({time, camera_from_world});
  const auto within = std::find_if(poses_.begin(), poses_.end(), [&](const Moment& moment) {
    return moment.time > time - kRestSeconds;
  });
  // The last pose before these 0.7 s is kept, too: it shows that the whole time is covered.
  const std::ptrdiff_t gone = std::min(within - poses_.begin(), std::ssize(poses_) - 1) - 1;
  if (gone > 0) poses_.erase(poses_.begin(), poses_.begin() + gone);
  if (poses_.front().time > time - kRestSeconds) return false;
  return std::none_of(poses_.begin(), poses_.end(), [&](const Moment& moment) {
    return picture_shift_px(camera, depth, moment.camera_from_world, camera_from_world) > kRestPx;
  });
}

void RecentPoses::move_world(const Rigid3& old_world_from_world) {
  for (Moment& moment : poses_) {
    moment.camera_from_world = moment.camera_from_world * old_world_from_world;
  }
}

}  // namespace palpable
