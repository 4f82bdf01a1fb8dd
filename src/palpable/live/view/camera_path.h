/// @file
/// The path of a camera through a room, to be drawn.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/live/render/map_renderer.h"
#include "palpable/live/track/tracker.h"

#include <optional>
#include <vector>

namespace palpable {

/// Where the camera has been: one point every centimetre, and a gap where it was lost or a loop was
/// closed. Points before the loop are not corrected by it. The memory is bounded: when a path
/// reaches 4,096 points, every second one is dropped and later ones are twice as far apart.
class CameraPath {
 public:
  /// Call it for every frame, in order.
  void add(const TrackedPose& camera);
  /// Appends the path as lines, up to where the camera is now.
  void draw(std::vector<MapLine>& lines) const;
  /// Poses along it, one for each point.
  [[nodiscard]] const std::vector<Rigid3>& poses() const { return poses_; }

 private:
  void thin();

  double step_ = 0.01;           // m between two points
  std::vector<Rigid3> poses_;    // world_from_camera
  std::vector<bool> continues_;  // a line leads here from the point before
  std::optional<Rigid3> now_;    // nothing while the camera is lost
};

}  // namespace palpable
