/// @file
/// The path of a camera through a room, for drawing.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/live/render/map_renderer.h"
#include "palpable/live/track/tracker.h"

#include <optional>
#include <vector>

namespace palpable {

/// The positions of the camera: one point every centimetre, with a gap where the camera was lost or
/// a loop was closed. Closing a loop does not correct earlier points. The memory is bounded: when a
/// path reaches 4,096 points, every second one is dropped, and later ones are twice as far apart.
class CameraPath {
 public:
  /// Adds a frame's pose; to be called for every frame, in order.
  void add(const TrackedPose& camera);
  /// Appends the path as lines, up to the camera's present position.
  void draw(std::vector<MapLine>& lines) const;
  /// The camera's poses at the points.
  [[nodiscard]] const std::vector<Rigid3>& poses() const { return poses_; }

 private:
  void thin();

  double step_ = 0.01;           // m between two points
  std::vector<Rigid3> poses_;    // world_from_camera
  std::vector<bool> continues_;  // whether a line leads here from the previous point
  std::optional<Rigid3> now_;    // nothing while the camera is lost
};

}  // namespace palpable
