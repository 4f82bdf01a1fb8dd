/// @file
/// Detects that a moving camera has come to rest, from its poses of the last 0.7 s.
#pragma once

#include "palpable/live/track/sighting.h"

#include <vector>

namespace palpable {

class RecentPoses {
 public:
  RecentPoses();

  /// Adds the pose of a frame and returns whether the camera has come to rest: whether during 0.7 s
  /// no part of the picture, at a depth of `depth` m, was more than 0.2 px from its present
  /// position. Does not allocate up to 120 frames per second.
  /// @param time  s, rising
  bool add_and_check_rest(const TrackCamera& camera, double depth, double time,
                          const Rigid3& camera_from_world);

  /// Transforms the stored poses after an adjustment has moved the world frame.
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
