/// @file
/// Has a camera that was moving come to rest? Its poses of the last 0.7 s.
#pragma once

#include "palpable/live/track/sighting.h"

#include <vector>

namespace palpable {

class RecentPoses {
 public:
  RecentPoses();

  /// Enters the pose of a frame and says whether the camera has come to rest: for 0.7 s no part of
  /// the picture, at `depth` m, was more than 0.2 px from where it is now. Takes no memory up to
  /// 120 frames a second.
  /// @param time  s, rising
  bool add_and_check_rest(const TrackCamera& camera, double depth, double time,
                          const Rigid3& camera_from_world);

  /// The world was moved under the camera by an adjustment.
  void move_world(const Rigid3& old_world_from_world);
  void clear() { poses_.clear(); }

  static constexpr double kRestPx = 0.2;

 private:
  struct Moment {
    double time;
    Rigid3 camera_from_world;
  };
  std::vector<Moment> poses_;
};

}  // namespace palpable
